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
import anisotropicquadremesher  # noqa: E402, F401 - so that the filter is seen with its own methods
from paraview import smtrace  # noqa: E402
from paraview import simple as pv  # noqa: E402
from PyQt5 import QtCore, QtWidgets  # noqa: E402
from vtkmodules.vtkCommonCore import vtkOutputWindow  # noqa: E402

errors = []
vtkOutputWindow.GetInstance().AddObserver("ErrorEvent", lambda *_: errors.append("an error in the output window"))
window = next(w for w in QtWidgets.QApplication.topLevelWidgets() if isinstance(w, QtWidgets.QMainWindow))


def check(condition, words):
    if not condition:
        raise AssertionError(words)


# PyQt lets go of Python's lock while it calls Qt, and ParaView's tracer does not expect that. Hence all that
# a user would do is queued, and each step of the test returns to ParaView's own event loop by `yield`.
def later(target, method, *arguments):
    QtCore.QMetaObject.invokeMethod(target, method, QtCore.Qt.QueuedConnection, *arguments)


def entry(menu, *words):
    """The action below a chain of menus, as a user reads them."""
    for action in menu.actions():
        if action.text().replace("&", "") == words[0]:
            if len(words) == 1:
                return action
            action.menu().aboutToShow.emit()  # when ParaView decides what can be chosen
            return entry(action.menu(), *words[1:])
    raise AssertionError("the menu has no entry " + words[0])


def shown(name):
    """Whether the widget of a property is on the panel: it carries the property's name."""
    panel = window.findChild(QtWidgets.QWidget, "propertiesPanel")
    return any(w.isVisible() for w in panel.findChildren(QtWidgets.QWidget, name))


def choose(name, text):
    panel = window.findChild(QtWidgets.QWidget, "propertiesPanel")
    box = panel.findChild(QtWidgets.QWidget, name).findChild(QtWidgets.QComboBox)
    check(box.findText(text) >= 0, name + " does not offer " + text)
    later(box, "setCurrentIndex", QtCore.Q_ARG(int, box.findText(text)))
    yield 0.3


def tick(name):
    panel = window.findChild(QtWidgets.QWidget, "propertiesPanel")
    later(panel.findChild(QtWidgets.QWidget, name).findChild(QtWidgets.QCheckBox), "click")
    yield 0.3


def type_number(name, number):
    panel = window.findChild(QtWidgets.QWidget, "propertiesPanel")
    edit = panel.findChild(QtWidgets.QWidget, name).findChild(QtWidgets.QLineEdit)
    later(edit, "setText", QtCore.Q_ARG(str, str(number)))
    later(edit, "editingFinished")
    yield 0.3


def apply():
    later(window.findChild(QtWidgets.QPushButton, "Accept"), "click")
    yield 1.0


def remesh():
    before = set(pv.GetSources())
    action = entry(window.menuBar(), "Filters", "Remeshing", "Anisotropic Quad Remesher")
    check(action.isEnabled(), "the menu entry cannot be chosen")
    check(not action.icon().isNull(), "the menu entry has no icon")
    later(action, "trigger")
    yield 0.5
    new = set(pv.GetSources()) - before
    check(len(new) == 1, "no filter was made")
    return pv.GetSources()[new.pop()]


def test_panel_and_apply():
    window.setGeometry(0, 0, 1400, 900)
    panel = window.findChild(QtWidgets.QDockWidget, "propertiesDock")
    window.resizeDocks([panel], [400], QtCore.Qt.Horizontal)
    surface = pv.OpenDataFile(os.environ["AQR_GUI_MESH"])
    pv.Show(surface)
    pv.SetActiveSource(surface)
    pv.ResetCamera()
    yield 0.5
    yield 0.5
    smtrace.start_trace()
    filter = yield from remesh()
    check(shown("Tolerance") and not shown("TargetNumberOfPoints"), "mode Tolerance shows the wrong widgets")
    check(not shown("Seed"), "an advanced property is shown from the first")
    yield from choose("DensityMode", "Number Of Points")
    check(shown("TargetNumberOfPoints") and not shown("Tolerance"), "mode Number Of Points shows the wrong widgets")
    yield from type_number("TargetNumberOfPoints", 2500)
    check(shown("FeatureAngle"), "the feature angle is missing")
    yield from tick("FeatureLines")
    check(not shown("FeatureAngle"), "the feature angle is shown without features")
    yield from tick("FeatureLines")
    yield from apply()
    check(not errors, "Apply raised an error")
    trace = smtrace.stop_trace()
    cells = filter[0].GetDataInformation().GetNumberOfCells()
    check(cells > 1000, "Apply made %d cells" % cells)
    view = pv.GetActiveView()
    display = pv.GetDisplayProperties(pv.OutputPort(filter, 0), view)
    check(display.Visibility and display.Representation == "Surface With Edges", "the mesh is not shown with edges")
    lines = pv.Show(pv.OutputPort(filter, 3), view)
    lines.LineWidth = 3
    check(list(lines.ColorArrayName) == ["CELLS", "LineType"], "the lines are not colored by type")
    lines.SetScalarBarVisibility(view, True)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -9, 9], [0, 0, 0], [0, 0, 1]
    pv.ResetCamera()
    pv.GetActiveCamera().Zoom(1.3)
    pv.Render()
    yield 0.5
    run_trace(trace, filter)
    pv.SetActiveSource(filter)
    yield 0.5
    picture = os.environ["AQR_GUI_PICTURE"]
    subprocess.run(["import", "-window", "root", picture], check=True)
    check(os.path.getsize(picture) > 20000, "the screenshot is empty")
    return filter


def run_trace(trace, filter):
    """What the trace says of the filter, run again, gives the same mesh."""
    check("AnisotropicQuadRemesher(" in trace, "the trace does not make the filter:\n" + trace)
    check("TargetNumberOfPoints = 2500" in trace, "the trace does not set what was set:\n" + trace)
    names = dict(vars(pv))
    names[trace.split("AnisotropicQuadRemesher(")[1].split("Input=")[1].split(")")[0]] = filter.Input
    lines = [line for line in trace.split("\n") if line.startswith("anisotropicQuadRemesher1") and "Display" not in line]
    exec("\n".join(lines), names)
    again = names["anisotropicQuadRemesher1"]
    again.UpdatePipeline()
    check(again[0].GetDataInformation().GetNumberOfPoints() == filter[0].GetDataInformation().GetNumberOfPoints(),
          "the trace gives another mesh")
    pv.Delete(again)


def test_cancel(filter):
    plain = filter.SMProxy.GetClientSideObject()
    began = []

    def cancel(algorithm, _):
        if 0.1 < algorithm.GetProgress() < 1.0:
            began.append(time.monotonic())
            algorithm.SetAbortExecute(1)

    observer = plain.AddObserver("ProgressEvent", cancel)
    yield from type_number("CurvatureRadius", 0.02)
    later(window.findChild(QtWidgets.QPushButton, "Accept"), "click")
    yield 0.1
    returned = time.monotonic()
    check(began, "nothing was cancelled")
    check(returned - began[0] < 3.0, "control came back after %.1f s" % (returned - began[0]))
    check(filter[0].GetDataInformation().GetNumberOfCells() == 0, "a cancelled Apply left cells behind")
    plain.RemoveObserver(observer)
    plain.SetAbortExecute(0)
    yield from type_number("CurvatureRadius", 0.01)
    yield from apply()
    check(filter[0].GetDataInformation().GetNumberOfCells() > 1000, "Apply after a cancelled one gave nothing")
    check(not errors, "an error after cancelling")


def test():
    filter = yield from test_panel_and_apply()
    yield from test_cancel(filter)


def step(steps):
    try:
        QtCore.QTimer.singleShot(int(1000 * next(steps)), lambda: step(steps))
        return
    except StopIteration:
        outcome = "passed"
    except BaseException:
        errors.append(traceback.format_exc())
        outcome = "failed"
    with open(os.environ["AQR_GUI_LOG"], "w") as log:
        log.write("\n".join(errors + [outcome]) + "\n")
    os._exit(0 if outcome == "passed" else 1)


QtCore.QTimer.singleShot(1500, lambda: step(test()))
