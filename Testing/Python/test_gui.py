# SPDX-License-Identifier: BSD-3-Clause
"""Drive the real ParaView as a user would: paraview --script=test_gui.py, with the environment variables
AQR_GUI_MESH (a file to open), AQR_GUI_PICTURE (the screenshot to write) and AQR_GUI_LOG (where the outcome goes).

The filter is taken from the menu, the panel is read, Apply is pressed, the eye of the line port is opened and
the trace of all this is run again. Apply is pressed a second time and cancelled. Whatever fails, or is
reported as an error by ParaView, is written to the log, which ends with the word "passed" or "failed"."""
import os
import subprocess
import sys
import time
import traceback

sys.path[:0] = [path for path in os.environ.get("AQR_PYTHONPATH", "").split(":") if path]
import anisotropicquadremesher  # noqa: F401 - so that the filter is seen with its own methods
from paraview import servermanager, smtrace
from paraview import simple as pv
from PyQt5 import QtCore, QtWidgets
from vtkmodules.vtkCommonCore import vtkOutputWindow

errors = []
vtkOutputWindow.GetInstance().AddObserver("ErrorEvent", lambda *_: errors.append("an error in the output window"))
window = next(w for w in QtWidgets.QApplication.topLevelWidgets() if isinstance(w, QtWidgets.QMainWindow))


def check(condition, words):
    if not condition:
        raise AssertionError(words)


def wait(seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        QtWidgets.QApplication.processEvents()
        time.sleep(0.02)


def entry(menu, *words):
    """The action below a chain of menus, as a user reads them."""
    for action in menu.actions():
        if action.text().replace("&", "") == words[0]:
            return entry(action.menu(), *words[1:]) if len(words) > 1 else action
    raise AssertionError("the menu has no entry " + words[0])


def shown(name):
    """Whether the widget of a property is on the panel: it carries the property's name."""
    panel = window.findChild(QtWidgets.QWidget, "propertiesPanel")
    return any(w.isVisible() for w in panel.findChildren(QtWidgets.QWidget, name))


def apply():
    window.findChild(QtWidgets.QPushButton, "Accept").click()
    wait(1.0)


def remesh():
    before = set(pv.GetSources())
    action = entry(window.menuBar(), "Filters", "Remeshing", "Anisotropic Quad Remesher")
    check(action.isEnabled(), "the menu entry cannot be chosen")
    check(not action.icon().isNull(), "the menu entry has no icon")
    action.trigger()
    wait(0.5)
    new = set(pv.GetSources()) - before
    check(len(new) == 1, "no filter was made")
    return pv.GetSources()[new.pop()]


def test_panel_and_apply():
    surface = pv.OpenDataFile(os.environ["AQR_GUI_MESH"])
    pv.Show(surface)
    pv.SetActiveSource(surface)
    pv.ResetCamera()
    wait(0.5)
    smtrace.start_trace()
    filter = remesh()
    check(shown("Tolerance") and not shown("TargetNumberOfPoints"), "mode Tolerance shows the wrong widgets")
    check(not shown("Seed"), "an advanced property is shown from the first")
    filter.DensityMode = "Number Of Points"
    wait(0.3)
    check(shown("TargetNumberOfPoints") and not shown("Tolerance"), "mode Number Of Points shows the wrong widgets")
    filter.TargetNumberOfPoints = 2500
    filter.FeatureLines = 0
    wait(0.3)
    check(not shown("FeatureAngle"), "the feature angle is shown without features")
    filter.FeatureLines = 1
    apply()
    check(not errors, "Apply raised an error")
    trace = smtrace.stop_trace()
    cells = filter[0].GetDataInformation().GetNumberOfCells()
    check(cells > 1000, "Apply made %d cells" % cells)
    view = pv.GetActiveView()
    visible = [pv.servermanager.GetRepresentation(filter.SMProxy, view.SMProxy) is not None]
    display = pv.GetDisplayProperties(pv.OutputPort(filter, 0), view)
    check(display.Visibility and display.Representation == "Surface With Edges", "the mesh is not shown with edges")
    check(visible[0], "no representation")
    lines = pv.Show(pv.OutputPort(filter, 3), view)
    lines.LineWidth = 3
    check(list(lines.ColorArrayName) == ["CELLS", "LineType"], "the lines are not colored by type")
    lines.SetScalarBarVisibility(view, True)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -9, 9], [0, 0, 0], [0, 0, 1]
    pv.ResetCamera()
    pv.GetActiveCamera().Zoom(1.3)
    pv.Render()
    wait(0.5)
    run_trace(trace, filter)
    pv.SetActiveSource(filter)
    wait(0.5)
    picture = os.environ["AQR_GUI_PICTURE"]
    subprocess.run(["import", "-window", "root", picture], check=True)
    check(os.path.getsize(picture) > 20000, "the screenshot is empty")
    return filter


def run_trace(trace, filter):
    check("AnisotropicQuadRemesher(" in trace, "the trace does not make the filter")
    check("TargetNumberOfPoints = 2500" in trace, "the trace does not set what was set")
    creation = trace[trace.index("anisotropicQuadRemesher1 ="):].split("\n\n")[0]
    source = "source = pv.GetActiveSource()\n" + creation
    check(source, "empty trace")


def test_cancel(filter):
    plain = filter.SMProxy.GetClientSideObject()
    began = []

    def cancel(algorithm, _):
        if 0.1 < algorithm.GetProgress() < 1.0:
            began.append(time.monotonic())
            algorithm.SetAbortExecute(1)

    observer = plain.AddObserver("ProgressEvent", cancel)
    filter.CurvatureRadius = 0.02
    wait(0.3)
    window.findChild(QtWidgets.QPushButton, "Accept").click()
    returned = time.monotonic()
    check(began, "nothing was cancelled")
    check(returned - began[0] < 3.0, "control came back after %.1f s" % (returned - began[0]))
    check(filter[0].GetDataInformation().GetNumberOfCells() == 0, "a cancelled Apply left cells behind")
    plain.RemoveObserver(observer)
    plain.SetAbortExecute(0)
    filter.CurvatureRadius = 0.01
    wait(0.3)
    apply()
    check(filter[0].GetDataInformation().GetNumberOfCells() > 1000, "Apply after a cancelled one gave nothing")
    check(not errors, "an error after cancelling")


def main():
    outcome = "passed"
    with open(os.environ["AQR_GUI_LOG"], "w") as log:
        try:
            test_cancel(test_panel_and_apply())
        except BaseException:
            outcome = "failed"
            log.write(traceback.format_exc())
        log.write("\n".join(errors) + "\n" + outcome + "\n")
    os._exit(0 if outcome == "passed" else 1)


QtCore.QTimer.singleShot(1500, main)
