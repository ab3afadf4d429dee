# SPDX-License-Identifier: BSD-3-Clause
"""Make the pictures of the user guide: make_pictures.py FOLDER [PARAMETER...]

One picture for a parameter, with the values side by side; every surface is made here."""
import math
import os
import sys

from vtkmodules.vtkCommonCore import VTK_FLOAT, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkContourFilter
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTextActor, vtkWindowToImageFilter)
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401

from anisotropicquadremesher import vtkAnisotropicQuadRemesher


def grid(n, m, shape, closed=True):
    points, cells = vtkPoints(), vtkCellArray()
    for i in range(n):
        for j in range(m):
            points.InsertNextPoint(shape(i / n, j / m))
    for i in range(n if closed else n - 1):
        for j in range(m if closed else m - 1):
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


def sheet(u, v):
    """An open sheet whose border is scalloped."""
    angle, radius = 2 * math.pi * (0.05 + 0.9 * u), 1 + 2 * v + 0.12 * v * math.cos(36 * math.pi * u)
    return radius * math.cos(angle), radius * math.sin(angle), 0.4 * math.cos(2 * radius + angle)


def cushion():
    """A cushion with three tunnels that are narrower than its faces, where a function vanishes."""
    size, step = (90, 70, 30), 0.05
    image = vtkImageData()
    image.SetDimensions(size)
    image.SetSpacing(step, step, step)
    image.AllocateScalars(VTK_FLOAT, 1)
    for k in range(size[2]):
        for j in range(size[1]):
            for i in range(size[0]):
                x, y, z = (step * (index - (count - 1) / 2) for index, count in zip((i, j, k), size))
                value = x * x / 4 + y * y / 2.25 + z * z / 0.25 - 1
                for tunnel in ((-0.8, -0.2), (0.1, 0.5), (0.7, -0.4)):
                    value += 1.8 * math.exp(-((x - tunnel[0]) ** 2 + (y - tunnel[1]) ** 2) / 0.012)
                image.SetScalarComponentFromDouble(i, j, k, 0, value)
    contour = vtkContourFilter()
    contour.SetInputData(image)
    contour.SetValue(0, 0.0)
    contour.Update()
    return contour.GetOutput()


def belt():
    """The ring with a belt that winds around it along diagonals of its quads."""
    surface, lines = grid(160, 60, ring), vtkCellArray()
    lines.InsertNextCell(121, [i * 60 + (i + 30) % 60 for i in range(121)])
    surface.SetLines(lines)
    return surface


RING, FLANGE = grid(160, 60, ring), grid(120, 60, flange)
SHEET, CUSHION = grid(200, 60, sheet, closed=False), cushion()
PICTURES = {
    "Tolerance": (RING, [0.004, 0.001, 0.0003], {}),
    "TargetNumberOfPoints": (RING, [500, 1500, 5000], {"DensityMode": 1}),
    "LargestSpacing": (FLANGE, [0.15, 0.05, 0.02], {"Tolerance": 0.004}),
    "Anisotropy": (RING, [0.0, 0.5, 1.0], {"DensityMode": 1, "TargetNumberOfPoints": 1500}),
    "Adaptivity": (RING, [0.0, 0.5, 1.0], {"DensityMode": 1, "TargetNumberOfPoints": 1500}),
    "PureQuads": (RING, [False, True], {"DensityMode": 1, "TargetNumberOfPoints": 1500}),
    "CurvatureRadius": (RING, [0.0, 0.01, 0.05], {"Tolerance": 0.001}),
    "SmoothingIterations": (RING, [0, 5, 50], {"Tolerance": 0.001}),
    "ConfidenceAngle": (RING, [5.0, 30.0, 90.0], {"Tolerance": 0.001}),
    "BoundaryLines": (SHEET, [False, True], {"Tolerance": 0.001}),
    "PreserveTopology": (CUSHION, [False, True], {"DensityMode": 1, "TargetNumberOfPoints": 60, "FeatureLines": False}),
    "FeatureLines": (FLANGE, [False, True], {"Tolerance": 0.002}),
    "Symmetry": (RING, [False, True], {"Tolerance": 0.002, "SymmetryNormal": (0, 1, 0)}),
    "LockLines": (belt(), [False, True], {"Tolerance": 0.002}),
    "LargestValence": (RING, [4, 5, 8], {"Tolerance": 0.002}),
    "ConvexPartition": (SHEET, [False, True], {"Tolerance": 0.004, "LargestValence": 12, "BoundaryLines": False}),
    "Seed": (RING, [0, 1, 2], {"Tolerance": 0.002}),
}


def lines_of(surface):
    """Its lines alone, thick and red."""
    lines, mapper, actor = vtkPolyData(), vtkPolyDataMapper(), vtkActor()
    lines.SetPoints(surface.GetPoints())
    lines.SetLines(surface.GetLines())
    mapper.SetInputData(lines)
    mapper.SetResolveCoincidentTopologyToPolygonOffset()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.8, 0, 0)
    actor.GetProperty().SetLineWidth(3)
    return actor


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
        remesh.AddObserver("WarningEvent", lambda *_: None)  # of lines passed over, say
        remesh.Update()
        mesh = remesh.GetOutput()
        label.SetInput("%s %s: %d points, %d faces" % (name, value, mesh.GetNumberOfPoints(), mesh.GetNumberOfPolys()))
        label.SetPosition(10, 10)
        label.GetTextProperty().SetColor(0, 0, 0)
        label.GetTextProperty().SetFontSize(16)
        renderer = vtkRenderer()
        renderer.SetViewport(i / len(values), 0, (i + 1) / len(values), 1)
        renderer.SetBackground(1, 1, 1)
        renderer.AddActor(actor)
        renderer.AddActor(lines_of(surface))
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


def main(folder, *names):
    os.makedirs(folder, exist_ok=True)
    for name in names or PICTURES:
        surface, values, fixed = PICTURES[name]
        writer = picture(name, surface, values, fixed)
        writer.SetFileName(os.path.join(folder, name + ".png"))
        writer.Write()
        print(name)


if __name__ == "__main__":
    main(*sys.argv[1:])
