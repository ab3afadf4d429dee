# SPDX-License-Identifier: BSD-3-Clause
"""Draw the principal directions of a surface as short strokes: blue along the minimum, red along the maximum
curvature.

usage: pvpython directions_as_glyphs.py PLUGIN.so PICTURE.png [INPUT]"""
import sys

from paraview import simple as pv


def strokes(directions, name, color, view):
    glyph = pv.Glyph(Input=directions, GlyphType="Line")
    glyph.OrientationArray = ["POINTS", name]
    glyph.ScaleArray = ["POINTS", "No scale array"]
    glyph.GlyphMode = "Uniform Spatial Distribution (Surface Sampling)"
    glyph.MaximumNumberOfSamplePoints = 3000
    bounds = directions.GetDataInformation().GetBounds()
    glyph.ScaleFactor = 0.015 * max(bounds[1] - bounds[0], bounds[3] - bounds[2], bounds[5] - bounds[4])
    display = pv.Show(glyph, view)
    display.ColorArrayName = [None, ""]
    display.AmbientColor = display.DiffuseColor = color
    display.LineWidth = 2.0
    return glyph


def main(plugin, picture, source=None):
    pv.LoadPlugin(plugin, remote=False, ns=vars(pv))
    surface = pv.OpenDataFile(source) if source else pv.Superquadric(
        ThetaResolution=120, PhiResolution=120, Toroidal=1, ThetaRoundness=0.6)
    remesh = pv.AnisotropicQuadRemesher(Input=surface)
    remesh.UpdatePipeline()
    directions = remesh["PrincipalDirections"]
    view = pv.CreateView("RenderView", ViewSize=[800, 600], UseColorPaletteForBackground=0, Background=[1, 1, 1])
    view.OrientationAxesVisibility = 0
    display = pv.Show(directions, view)
    display.ColorArrayName = [None, ""]
    glyphs = [
        strokes(directions, "MinDirection", [0.16, 0.38, 0.79], view),
        strokes(directions, "MaxDirection", [0.84, 0.19, 0.15], view),
    ]
    view.CameraPosition, view.CameraViewUp = [0, -1, 1], [0, 0, 1]
    pv.ResetCamera(view)
    pv.SaveScreenshot(picture, view)
    pv.Delete(view)  # while its window is still there
    cells = [glyph.GetDataInformation().GetNumberOfCells() for glyph in glyphs]
    print("strokes:", cells)
    return 0 if min(cells) > 100 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
