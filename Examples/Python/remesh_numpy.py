#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""NumPy arrays in and out, with progress.

usage: remesh_numpy.py [POINTS]

Makes a wavy torus from arrays, remeshes it to POINTS points (1500) and prints what came out."""
import json
import sys

import numpy as np
from vtkmodules.numpy_interface import dataset_adapter as dsa
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData

from anisotropicquadremesher import vtkAnisotropicQuadRemesher


def wavy_torus(around=160, across=80):
    """Points (n, 3) and triangles (m, 3)."""
    u, v = np.meshgrid(np.arange(around) * 2 * np.pi / around, np.arange(across) * 2 * np.pi / across, indexing="ij")
    radius = 3 + (1 + 0.2 * np.cos(5 * u)) * np.cos(v)
    points = np.stack([radius * np.cos(u), radius * np.sin(u), (1 + 0.2 * np.cos(5 * u)) * np.sin(v)], -1)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")
    a, b = i * across + j, (i + 1) % around * across + j
    c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
    triangles = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    return points.reshape(-1, 3), triangles


def to_polydata(points, triangles):
    surface = vtkPolyData()
    vtk_points = vtkPoints()
    vtk_points.SetData(numpy_to_vtk(points, deep=True))
    surface.SetPoints(vtk_points)
    offsets = np.arange(0, 3 * len(triangles) + 1, 3)
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(triangles.ravel().astype(np.int64), deep=True)
    )
    surface.SetPolys(cells)
    return surface


def main():
    points, triangles = wavy_torus()
    remesh = vtkAnisotropicQuadRemesher()
    remesh.SetInputData(to_polydata(points, triangles))
    remesh.SetDensityModeToNumberOfPoints()
    remesh.SetTargetNumberOfPoints(int(sys.argv[1]) if len(sys.argv) > 1 else 1500)
    seen = []
    remesh.AddObserver("ProgressEvent", lambda filter, event: seen.append(filter.GetProgressText() or "start"))
    remesh.Update()

    mesh = dsa.WrapDataObject(remesh.GetOutput(0))
    sides = np.diff(vtk_to_numpy(remesh.GetOutput(0).GetPolys().GetOffsetsArray()))
    print("stages:", ", ".join(dict.fromkeys(seen)))
    print("points:", len(mesh.Points), "faces:", len(sides), "quads: %.0f %%" % (100 * np.mean(sides == 4)))
    print("counts:", json.loads(remesh.GetReport())["counts"])
    directions = dsa.WrapDataObject(remesh.GetOutput(1)).PointData
    skew = np.abs(np.sum(np.asarray(directions["MinDirection"]) * np.asarray(directions["MaxDirection"]), axis=1))
    print("largest cosine between the principal directions: %.1e" % skew.max())
    return 0 if len(sides) and skew.max() < 1e-4 else 1


if __name__ == "__main__":
    sys.exit(main())
