# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the plugin under pvpython: test_plugin.py PLUGIN.so XML; each is named after what would have
gone wrong."""
import json
import os
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree as ElementTree

import anisotropicquadremesher  # noqa: F401 - so that filters are seen with their own methods
from paraview import servermanager
from paraview import simple as pv
from paraview import smstate
from vtkmodules.vtkCommonDataModel import vtkCompositeDataSet

PLUGIN, XML = sys.argv[1:3]
PORTS = ("Remeshed", "PrincipalDirections", "Confidence", "IntegratedLines")


def fresh_session():
    pv.ResetSession()
    pv.LoadPlugin(PLUGIN, remote=False, ns=vars(pv))


class Plugin(unittest.TestCase):
    def setUp(self):
        fresh_session()
        self.sphere = pv.Sphere(ThetaResolution=60, PhiResolution=40)
        self.filter = pv.AnisotropicQuadRemesher(Input=self.sphere)
        self.filter.Tolerance = 0.002

    def test_named_ports_hold_their_data(self):
        self.filter.UpdatePipeline()
        for index, name in enumerate(PORTS):
            self.assertEqual(self.filter.SMProxy.GetOutputPortName(index), name)
            self.assertGreater(servermanager.Fetch(self.filter, idx=index).GetNumberOfCells(), 0, name)

    def test_every_property_reaches_the_filter(self):
        properties = {p.get("name"): p for p in ElementTree.parse(XML).iter() if p.tag.endswith("VectorProperty")}
        plain = self.filter.SMProxy.GetClientSideObject()
        for name, element in properties.items():
            label = element.get("label").replace(" ", "")
            self.assertEqual(label, name)
            self.assertTrue(hasattr(self.filter, name), name)
            if hasattr(plain, "Get" + name):
                value = getattr(plain, "Get" + name)()
                value = list(value) if isinstance(value, tuple) else [value]
                for held, shown in zip(value, str(self.xml_value(element)).split(), strict=True):
                    self.assertAlmostEqual(float(held), float(shown), msg=name)

    def xml_value(self, element):
        return 0.002 if element.get("name") == "Tolerance" else element.get("default_values")

    def test_every_property_is_documented(self):
        for element in ElementTree.parse(XML).iter():
            if element.tag.endswith("VectorProperty"):
                documentation = element.find("Documentation")
                self.assertIsNotNone(documentation, element.get("name"))
                self.assertGreater(len(documentation.text), 20, element.get("name"))
                self.assertGreater(len(documentation.get("short_help")), 10, element.get("name"))

    def test_every_property_is_in_a_group(self):
        root = ElementTree.parse(XML)
        grouped = {p.get("name") for g in root.iter("PropertyGroup") for p in g.iter("Property")}
        names = {p.get("name") for p in root.iter() if p.tag.endswith("VectorProperty")}
        self.assertEqual(grouped, names)

    def test_target_number_of_points_is_met(self):
        self.filter.DensityMode = "Number Of Points"
        self.filter.TargetNumberOfPoints = 1000
        self.filter.UpdatePipeline()
        points = self.filter[0].GetDataInformation().GetNumberOfPoints()
        self.assertLessEqual(abs(points - 1000), 50)

    def test_density_array_is_chosen_from_the_point_arrays(self):
        arrays = pv.Elevation(Input=self.sphere, LowPoint=[0, 0, -0.5], HighPoint=[0, 0, 0.5])
        arrays.ScalarRange = [0.1, 4.0]
        remesh = pv.AnisotropicQuadRemesher(Input=arrays, Tolerance=0.002)
        arrays.UpdatePipeline()
        domain = remesh.SMProxy.GetProperty("DensityArray").FindDomain("vtkSMArrayListDomain")
        self.assertEqual([domain.GetString(i) for i in range(domain.GetNumberOfStrings())], ["Elevation"])
        remesh.UpdatePipeline()
        even = share_above(remesh)
        remesh.UseDensityArray = 1
        remesh.DensityArray = ["POINTS", "Elevation"]
        remesh.UpdatePipeline()
        self.assertLess(abs(even - 0.5), 0.2)
        self.assertGreater(share_above(remesh), even + 0.1)

    def test_lock_array_is_chosen_from_the_cell_arrays(self):
        numbered = pv.GenerateIds(Input=self.sphere, CellIdsArrayName="number")
        remesh = pv.AnisotropicQuadRemesher(Input=numbered, Tolerance=0.002, LockLines=1, UseLockArray=1)
        numbered.UpdatePipeline()
        domain = remesh.SMProxy.GetProperty("LockArray").FindDomain("vtkSMArrayListDomain")
        self.assertEqual([domain.GetString(i) for i in range(domain.GetNumberOfStrings())], ["number"])
        remesh.LockArray = ["CELLS", "number"]
        remesh.UpdatePipeline()
        self.assertGreater(remesh[0].GetDataInformation().GetNumberOfPoints(), 100)

    def test_blocks_are_remeshed_one_by_one_on_all_ports(self):
        far = pv.Sphere(Center=[3, 0, 0], ThetaResolution=40, PhiResolution=30)
        blocks = pv.GroupDatasets(Input=[self.sphere, far])
        remesh = pv.AnisotropicQuadRemesher(Input=blocks, Tolerance=0.002)
        remesh.UpdatePipeline()
        for index, name in enumerate(PORTS):
            output = servermanager.Fetch(remesh, idx=index)
            self.assertIsInstance(output, vtkCompositeDataSet, name)
            bounds = [leaf.GetBounds() for leaf in leaves(output)]
            self.assertEqual(len(bounds), 2, name)
            self.assertAlmostEqual(sum(bounds[0][:2]) / 2, 0, delta=0.1, msg=name)
            self.assertAlmostEqual(sum(bounds[1][:2]) / 2, 3, delta=0.1, msg=name)

    def test_ports_look_right_untouched(self):
        self.filter.UpdatePipeline()
        view = pv.CreateView("RenderView")
        shown = [pv.Show(pv.OutputPort(self.filter, index), view) for index in range(4)]
        self.assertEqual(shown[0].Representation, "Surface With Edges")
        self.assertEqual(list(shown[2].ColorArrayName), ["POINTS", "Confidence"])
        self.assertEqual(list(shown[3].ColorArrayName), ["CELLS", "LineType"])
        self.assertIn("Minimum curvature", list(shown[3].LookupTable.Annotations))
        # What the panel of Glyph takes for orientation.
        vectors = servermanager.Fetch(self.filter, idx=1).GetPointData().GetVectors()
        self.assertEqual(vectors.GetName(), "MinDirection")
        pv.Delete(view)

    def test_state_is_restored(self):
        self.filter.DensityMode = "Number Of Points"
        self.filter.TargetNumberOfPoints = 700
        self.filter.FeatureAngle = 55.0
        self.filter.ConvexPartition = 0
        with tempfile.TemporaryDirectory() as folder:
            pv.RenameSource("remesher", self.filter)
            pv.SetActiveSource(self.filter)
            state = os.path.join(folder, "state.pvsm")
            pv.SaveState(state)
            script = smstate.get_state()
            for kind in ("pvsm", "Python"):
                fresh_session()
                if kind == "Python":
                    exec(compile(script, "state", "exec"), {"__name__": "state"})
                else:
                    pv.LoadState(state)
                self.filter = pv.FindSource("remesher")
                self.sphere = self.filter.Input
                self.assertEqual(self.filter.DensityMode, "Number Of Points")
                self.assertEqual(self.filter.TargetNumberOfPoints, 700)
                self.assertEqual(self.filter.FeatureAngle, 55.0)
                self.assertEqual(self.filter.ConvexPartition, 0)
                self.filter.UpdatePipeline()
                self.assertGreater(self.filter[0].GetDataInformation().GetNumberOfCells(), 0)

    def test_time_series_computes_only_what_changed(self):
        # A surface that stands still with an array that changes, and one that moves.
        for moves in (False, True):
            series = pv.ProgrammableSource(OutputDataSetType="vtkPolyData")
            series.ScriptRequestInformation = (
                "executive = self.GetExecutive(); info = executive.GetOutputInformation(0)\n"
                "info.Set(executive.TIME_STEPS(), [0.0, 1.0, 2.0], 3)\n"
                "info.Set(executive.TIME_RANGE(), [0.0, 2.0], 2)\n")
            series.Script = SERIES % (1.0 if moves else 0.0)
            remesh = pv.AnisotropicQuadRemesher(Input=series, Tolerance=0.002)
            plain = remesh.SMProxy.GetClientSideObject()
            heights = []
            for step in (0.0, 1.0, 2.0):
                remesh.UpdatePipeline(step)
                reused = {stage["name"]: stage["reused"] for stage in json.loads(plain.GetReport())["stages"]}
                self.assertEqual(reused["curvature"], step > 0 and not moves)
                bounds = remesh[0].GetDataInformation().GetBounds()
                heights.append(bounds[5] - bounds[4])
                self.assertAlmostEqual(remesh[0].PointData["time"].GetRange()[1], step)
            self.assertEqual(heights[2] > 1.1 * heights[0], moves)

    def test_cancel_in_the_middle_returns_control(self):
        big = pv.Sphere(ThetaResolution=500, PhiResolution=500)
        remesh = pv.AnisotropicQuadRemesher(Input=big, Tolerance=0.0001)
        plain = remesh.SMProxy.GetClientSideObject()
        cancelled = []

        def cancel(filter, event):
            if 0.05 < filter.GetProgress() < 1.0:
                cancelled.append(time.monotonic())
                filter.SetAbortExecute(1)

        observer = plain.AddObserver("ProgressEvent", cancel)
        remesh.UpdatePipeline()
        self.assertGreater(len(cancelled), 0)
        self.assertLess(time.monotonic() - cancelled[0], 5.0)
        self.assertEqual(remesh[0].GetDataInformation().GetNumberOfCells(), 0)
        plain.RemoveObserver(observer)
        plain.SetAbortExecute(0)
        remesh.Tolerance = 0.005
        remesh.UpdatePipeline()
        self.assertGreater(remesh[0].GetDataInformation().GetNumberOfCells(), 0)

    def test_another_paraview_is_refused_with_the_reason(self):
        # The plugin as if built for ParaView 5.10: its libraries carry the version in their names.
        with tempfile.TemporaryDirectory() as folder:
            other = os.path.join(folder, os.path.basename(PLUGIN))
            with open(PLUGIN, "rb") as file, open(other, "wb") as copy:
                copy.write(file.read().replace(b"-pv5.11.so", b"-pv5.10.so"))
            script = "from paraview import simple as pv\npv.LoadPlugin(%r, remote=False, ns=globals())\n" % other
            run = subprocess.run([os.environ.get("PVPYTHON", "pvpython"), "-c", script], capture_output=True, text=True)
            self.assertNotEqual(run.returncode, 0)
            self.assertIn("pv5.10", run.stdout + run.stderr)


SERIES = """
import numpy
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkCommonCore import vtkDoubleArray
time = self.GetExecutive().GetOutputInformation(0).Get(self.GetExecutive().UPDATE_TIME_STEP()) or 0.0
sphere = vtkSphereSource()
sphere.SetThetaResolution(60); sphere.SetPhiResolution(40)
sphere.Update()
surface = sphere.GetOutput()
for i in range(surface.GetNumberOfPoints()):
    x, y, z = surface.GetPoint(i)
    surface.GetPoints().SetPoint(i, x, y, z * (1 + 0.3 * time * %s))
array = vtkDoubleArray(); array.SetName("time")
array.SetNumberOfTuples(surface.GetNumberOfPoints()); array.Fill(time)
surface.GetPointData().AddArray(array)
self.GetOutputDataObject(0).ShallowCopy(surface)
"""


def leaves(data):
    iterator = data.NewIterator()
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        yield iterator.GetCurrentDataObject()
        iterator.GoToNextItem()


def share_above(remesh):
    mesh = servermanager.Fetch(remesh, idx=0)
    heights = [mesh.GetPoint(i)[2] for i in range(mesh.GetNumberOfPoints())]
    return sum(z > 0 for z in heights) / len(heights)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
