# SPDX-License-Identifier: BSD-3-Clause
"""Make the pictures of the user guide: make_pictures.py FOLDER

One picture for a parameter, with the values side by side; every surface is made here."""
import math
import os
import sys

from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

from anisotropicquadremesher import vtkAnisotropicQuadRemesher


def grid(n, m, shape):
    points, cells = vtkPoints(), vtkCellArray()
    for i in range(n):
        for j in range(m):
            points.InsertNextPoint(shape(i / n, j / m))
    for i in range(n):
        for j in range(m):
            a, b = i * m + j, (i + 1) % n * m + j
            c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
            for triangle in ((a, b, c), (a, c, d)):
                cells.InsertNextCell(3, triangle)
    surface = vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(cells)
    return surface


def ring(u, v):
    u, v = 2 * math.pi * u, 2 * math.pi * v
    tube = 0.8 + 0.2 * math.cos(5 * u) + 0.06 * math.sin(3 * v)
    return (2.2 + tube * math.cos(v)) * math.cos(u), (2.2 + tube * math.cos(v)) * math.sin(u), tube * math.sin(v)


def flange(u, v):
    profile = [(1.0, 0.0), (2.6, 0.0), (2.6, 0.5), (1.7, 0.5), (1.5, 1.6), (1.0, 1.6)]
    corner, t = int(v * 6 + 1e-9) % 6, v * 6 - int(v * 6 + 1e-9)
    (r0, z0), (r1, z1) = profile[corner], profile[(corner + 1) % 6]
    radius = r0 + t * (r1 - r0)
    return radius * math.cos(2 * math.pi * u), radius * math.sin(2 * math.pi * u), z0 + t * (z1 - z0)


RING, FLANGE = grid(160, 60, ring), grid(120, 60, flange)
PICTURES = {
    "Tolerance": (RING, [0.004, 0.001, 0.0003], {}),
    "TargetNumberOfPoints": (RING, [500, 1500, 5000], {"DensityMode": 1}),
    "LargestSpacing": (FLANGE, [0.15, 0.05, 0.02], {"Tolerance": 0.004}),
    "CurvatureRadius": (RING, [0.0, 0.01, 0.05], {"Tolerance": 0.001}),
    "SmoothingIterations": (RING, [0, 5, 50], {"Tolerance": 0.001}),
    "FeatureLines": (FLANGE, [False, True], {"Tolerance": 0.002}),
    "LargestValence": (RING, [4, 5, 8], {"Tolerance": 0.002}),
}


def picture(name, surface, values, fixed):
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(400 * len(values), 340)
    for i, value in enumerate(values):
        remesh = vtkAnisotropicQuadRemesher()
        remesh.SetInputData(surface)
        for key, number in list(fixed.items()) + [(name, value)]:
            getattr(remesh, "Set" + key)(number)
        mapper = vtkPolyDataMapper()
        mapper.SetInputConnection(remesh.GetOutputPort())
        mapper.ScalarVisibilityOff()
        actor = vtkActor()
        actor.SetMapper(mapper)
        actor.GetProperty().EdgeVisibilityOn()
        label = vtkTextActor()
        remesh.Update()
        label.SetInput("%s %s: %d points" % (name, value, remesh.GetOutput().GetNumberOfPoints()))
        label.SetPosition(10, 10)
        label.GetTextProperty().SetColor(0, 0, 0)
        label.GetTextProperty().SetFontSize(16)
        renderer = vtkRenderer()
        renderer.SetViewport(i / len(values), 0, (i + 1) / len(values), 1)
        renderer.SetBackground(1, 1, 1)
        renderer.AddActor(actor)
        renderer.AddViewProp(label)
        renderer.GetActiveCamera().SetPosition(0, -1.2, 1)
        renderer.GetActiveCamera().SetViewUp(0, 0, 1)
        renderer.ResetCamera()
        renderer.GetActiveCamera().Zoom(1.3)
        window.AddRenderer(renderer)
    window.Render()
    image = vtkWindowToImageFilter()
    image.SetInput(window)
    writer = vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    return writer


def main(folder):
    os.makedirs(folder, exist_ok=True)
    for name, (surface, values, fixed) in PICTURES.items():
        writer = picture(name, surface, values, fixed)
        writer.SetFileName(os.path.join(folder, name + ".png"))
        writer.Write()
        print(name)


if __name__ == "__main__":
    main(*sys.argv[1:])
