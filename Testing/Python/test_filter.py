#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the Python wrapper under plain Python; each is named after what would have gone wrong."""
import json
import unittest

from vtkmodules.vtkCommonComputationalGeometry import vtkParametricTorus
from vtkmodules.vtkCommonDataModel import vtkDataObject
from vtkmodules.vtkFiltersSources import vtkParametricFunctionSource

from anisotropicquadremesher import vtkAnisotropicQuadRemesher


def torus():
    source = vtkParametricFunctionSource()
    source.SetParametricFunction(vtkParametricTorus())
    source.SetUResolution(80)
    source.SetVResolution(40)
    source.Update()
    return source


class Filter(unittest.TestCase):
    def setUp(self):
        self.filter = vtkAnisotropicQuadRemesher()
        self.source = torus()
        self.filter.SetInputConnection(self.source.GetOutputPort())
        self.filter.SetTolerance(0.002)

    def test_all_ports_are_filled(self):
        self.filter.Update()
        for port in range(4):
            self.assertGreater(self.filter.GetOutput(port).GetNumberOfCells(), 0)

    def test_constants_are_wrapped(self):
        self.assertEqual(vtkAnisotropicQuadRemesher.INTEGRATED_LINES, 3)
        self.filter.SetDensityModeToNumberOfPoints()
        self.assertEqual(self.filter.GetDensityMode(), vtkAnisotropicQuadRemesher.NUMBER_OF_POINTS)
        self.filter.SetDensityModeToTolerance()
        self.assertEqual(self.filter.GetDensityMode(), vtkAnisotropicQuadRemesher.TOLERANCE)

    def test_report_is_json_before_and_after(self):
        self.assertEqual(json.loads(self.filter.GetReport()), {})
        self.filter.Update()
        report = json.loads(self.filter.GetReport())
        self.assertEqual(report["counts"]["points"], self.filter.GetOutput().GetNumberOfPoints())
        self.assertEqual(report["counts"]["faces"], self.filter.GetOutput().GetNumberOfPolys())

    def test_progress_reaches_the_end(self):
        seen = []
        self.filter.AddObserver("ProgressEvent", lambda f, event: seen.append(f.GetProgress()))
        self.filter.Update()
        self.assertEqual(seen, sorted(seen))
        self.assertEqual(seen[-1], 1.0)

    def test_missing_array_is_one_error(self):
        errors = []
        self.filter.AddObserver("ErrorEvent", lambda f, event: errors.append(event))
        self.filter.UseDensityArrayOn()
        self.filter.SetInputArrayToProcess(0, 0, 0, vtkDataObject.FIELD_ASSOCIATION_POINTS, "none")
        self.filter.Update()
        self.assertEqual(len(errors), 1)
        self.assertEqual(self.filter.GetOutput().GetNumberOfPoints(), 0)


if __name__ == "__main__":
    unittest.main()
