# SPDX-License-Identifier: BSD-3-Clause
"""Start the real ParaView under a virtual display of its own with the plugin found by itself, and run
test_gui.py in it:

    run_gui.py PARAVIEW PLUGIN.so PYTHONPATH PICTURE.png

The exit code is zero when all went well; PICTURE.png then shows panel, mesh and lines."""
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
KNOT = os.path.join(HERE, "../../Examples/Python/make_knot.py")


def main(paraview, plugin, pythonpath, picture):
    with tempfile.TemporaryDirectory() as home:
        settings = os.path.join(home, ".config/ParaView")
        os.makedirs(settings)
        with open(os.path.join(settings, "ParaView5.11.0.ini"), "w") as file:
            file.write("[General]\nGeneralSettings.ShowWelcomeDialog=false\n")
        mesh = os.path.join(home, "knot.ply")
        subprocess.run([sys.executable, KNOT, mesh, "300", "40"], check=True)
        log = os.path.join(home, "log")
        reader, writer = os.pipe()
        screen = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writer), "-screen", "0", "1400x900x24"], pass_fds=[writer],
            stderr=subprocess.DEVNULL)
        os.close(writer)
        try:
            display = os.read(reader, 16).decode().strip()
            environment = dict(
                os.environ, HOME=home, XDG_RUNTIME_DIR=home, DISPLAY=":" + display,
                PV_PLUGIN_PATH=os.path.dirname(plugin), AQR_PYTHONPATH=pythonpath, AQR_GUI_MESH=mesh,
                AQR_GUI_PICTURE=os.path.abspath(picture), AQR_GUI_LOG=log)
            name = os.path.splitext(os.path.basename(plugin))[0]
            command = [paraview, "--plugins=" + name, "--script=" + os.path.join(HERE, "test_gui.py")]
            run = subprocess.run(command, env=environment, timeout=240, capture_output=True, text=True)
        finally:
            screen.terminate()
            screen.wait()
        outcome = open(log).read() if os.path.exists(log) else run.stdout + run.stderr
        print(outcome)
        return 0 if outcome.endswith("passed\n") else 1


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
