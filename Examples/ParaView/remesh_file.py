# SPDX-License-Identifier: BSD-3-Clause
"""Remesh a file with the plugin.

usage: pvpython remesh_file.py PLUGIN.so [INPUT OUTPUT [POINTS]]

Without INPUT a sphere is remeshed and the counts of the four ports are printed."""
import sys

from paraview import simple as pv

PORTS = ("Remeshed", "PrincipalDirections", "Confidence", "IntegratedLines")


def main(plugin, source=None, target=None, points=1000):
    pv.LoadPlugin(plugin, remote=False, ns=vars(pv))
    surface = pv.OpenDataFile(source) if source else pv.Sphere(ThetaResolution=100, PhiResolution=100)
    remesh = pv.AnisotropicQuadRemesher(Input=surface)
    remesh.DensityMode = "Number Of Points"
    remesh.TargetNumberOfPoints = int(points)
    remesh.UpdatePipeline()
    if target:
        pv.SaveData(target, proxy=pv.OutputPort(remesh, 0))
    cells = {name: remesh[name].GetDataInformation().GetNumberOfCells() for name in PORTS}
    print(cells)
    return 0 if all(cells.values()) else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
