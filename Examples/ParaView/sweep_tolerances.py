# SPDX-License-Identifier: BSD-3-Clause
"""Remesh with ever smaller tolerances and write the sweep as an animation.

usage: pvpython sweep_tolerances.py PLUGIN.so ANIMATION [INPUT [FRAMES]]

ANIMATION may be a film (.ogv, .avi) or pictures (.png, numbered). Only the first frame computes curvature and
directions: the tolerance does not change them."""
import sys

from paraview import simple as pv


def main(plugin, animation, source=None, frames=12):
    pv.LoadPlugin(plugin, remote=False, ns=vars(pv))
    surface = pv.OpenDataFile(source) if source else pv.Superquadric(
        ThetaResolution=120, PhiResolution=120, Toroidal=1, ThetaRoundness=0.6)
    remesh = pv.AnisotropicQuadRemesher(Input=surface, Tolerance=0.005)
    view = pv.CreateView("RenderView", ViewSize=[640, 480], UseColorPaletteForBackground=0, Background=[1, 1, 1])
    view.OrientationAxesVisibility = 0
    pv.Show(remesh, view)
    view.CameraPosition, view.CameraViewUp = [0, -1, 1], [0, 0, 1]
    pv.ResetCamera(view)

    scene = pv.GetAnimationScene()
    scene.PlayMode = "Sequence"
    scene.NumberOfFrames = int(frames)
    track = pv.GetAnimationTrack("Tolerance", proxy=remesh)
    # Exponential, so that each frame has the same part more points than the one before.
    first = pv.CompositeKeyFrame(KeyTime=0.0, KeyValues=[0.005], Interpolation="Exponential")
    first.Base, first.StartPower, first.EndPower = 10.0, -2.3, -3.3
    track.KeyFrames = [first, pv.CompositeKeyFrame(KeyTime=1.0, KeyValues=[0.0005])]
    counts = []
    for frame in range(int(frames)):
        scene.AnimationTime = frame / max(1, int(frames) - 1)
        pv.Render(view)
        counts.append(remesh[0].GetDataInformation().GetNumberOfPoints())
    print("points:", counts)
    pv.SaveAnimation(animation, view, FrameWindow=[0, int(frames) - 1])
    pv.Delete(view)  # while its window is still there
    return 0 if counts[-1] > 2 * counts[0] > 0 else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
