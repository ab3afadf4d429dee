# SPDX-License-Identifier: BSD-3-Clause
"""Compare the remesher with ParaView's Quadric Clustering and Decimate: error against number of points, as a plot.

usage: pvpython compare_with_decimation.py PLUGIN.so PLOT.png [INPUT]

The error is the root mean square of the distances from the input's points to the result, over the diagonal of
the input's bounding box."""
import math
import sys

from paraview import servermanager
from paraview import simple as pv
from vtkmodules.vtkCommonCore import mutable, vtkDoubleArray
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator, vtkTable
from vtkmodules.vtkFiltersCore import vtkTriangleFilter

COLORS = {"Remesher": [0.16, 0.38, 0.79], "QuadricClustering": [0.84, 0.19, 0.15], "Decimate": [0.3, 0.3, 0.3]}


def error(surface, result):
    triangles = vtkTriangleFilter()
    triangles.SetInputData(result)
    triangles.Update()
    locator = vtkStaticCellLocator()
    locator.SetDataSet(triangles.GetOutput())
    locator.BuildLocator()
    total, point, cell, sub, distance = 0.0, [0.0] * 3, mutable(0), mutable(0), mutable(0.0)
    for i in range(0, surface.GetNumberOfPoints(), 3):
        locator.FindClosestPoint(surface.GetPoint(i), point, cell, sub, distance)
        total += float(distance)
    return math.sqrt(total / len(range(0, surface.GetNumberOfPoints(), 3))) / surface.GetLength()


def table(rows):
    """One table for a method: how many points, and the error."""
    result = vtkTable()
    for column, name in enumerate(("Points", "Error")):
        array = vtkDoubleArray()
        array.SetName(name)
        for row in rows:
            array.InsertNextValue(row[column])
        result.AddColumn(array)
    return result


def main(plugin, plot, source=None):
    pv.LoadPlugin(plugin, remote=False, ns=vars(pv))
    start = pv.OpenDataFile(source) if source else pv.Superquadric(
        ThetaResolution=160, PhiResolution=160, Toroidal=1, ThetaRoundness=0.6)
    surface = pv.Clean(Input=pv.Triangulate(Input=start))
    surface.UpdatePipeline()
    whole = servermanager.Fetch(surface)
    results = {name: [] for name in COLORS}
    for points in (500, 1000, 2000, 4000):
        remesh = pv.AnisotropicQuadRemesher(Input=surface, DensityMode="Number Of Points", TargetNumberOfPoints=points)
        divisions = max(4, round(math.sqrt(points) * 0.5))
        cluster = pv.QuadricClustering(Input=surface, NumberofDimensions=[divisions] * 3)
        decimate = pv.Decimate(Input=surface, TargetReduction=1 - points / whole.GetNumberOfPoints(), PreserveTopology=1)
        for name, method in zip(COLORS, (remesh, cluster, decimate)):
            method.UpdatePipeline()
            result = servermanager.Fetch(method, idx=0)
            results[name].append((result.GetNumberOfPoints(), error(whole, result)))
    view = pv.CreateView("XYChartView", ViewSize=[800, 600])
    view.BottomAxisTitle, view.LeftAxisTitle = "points", "error / diagonal"
    view.LeftAxisLogScale = view.BottomAxisLogScale = 1
    for name, rows in results.items():
        print(name, " ".join("%d:%.2e" % row for row in rows))
        producer = pv.TrivialProducer(registrationName=name)
        producer.GetClientSideObject().SetOutput(table(rows))
        display = pv.Show(producer, view)
        display.AttributeType = "Row Data"
        display.UseIndexForXAxis = 0
        display.XArrayName = "Points"
        display.SeriesVisibility = ["Error"]
        display.SeriesLabel = ["Error", name]
        display.SeriesColor = ["Error"] + [str(c) for c in COLORS[name]]
        display.SeriesLineThickness = ["Error", "3"]
        display.SeriesMarkerStyle = ["Error", "4"]
    pv.SaveScreenshot(plot, view)
    pv.Delete(view)  # while its window is still there
    return 0 if all(row[1] > 0 for rows in results.values() for row in rows) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
