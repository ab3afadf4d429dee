#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Tests of aqr-remesh as a user meets it.

usage: test_program.py PROGRAM NO_NETWORK_LIBRARY [unittest arguments]

Each test is named after what would have gone wrong."""
import json
import math
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree

PROGRAM, NO_NETWORK = sys.argv[1:3]


def write_torus(path, around=80, across=40, triangles=None):
    """An ASCII .ply of a torus."""
    points, faces = [], []
    for i in range(around):
        for j in range(across):
            u, v = 2 * math.pi * i / around, 2 * math.pi * j / across
            points.append(((3 + math.cos(v)) * math.cos(u), (3 + math.cos(v)) * math.sin(u), math.sin(v)))
            a, b = i * across + j, (i + 1) % around * across + j
            c, d = (i + 1) % around * across + (j + 1) % across, i * across + (j + 1) % across
            faces += [(a, b, c), (a, c, d)]
    write_ply(path, points, faces)


def write_ply(path, points, faces):
    with open(path, "w") as f:
        f.write("ply\nformat ascii 1.0\nelement vertex %d\n" % len(points))
        f.write("property double x\nproperty double y\nproperty double z\n")
        f.write("element face %d\nproperty list uchar int vertex_indices\nend_header\n" % len(faces))
        f.writelines("%.17g %.17g %.17g\n" % p for p in points)
        f.writelines("%d %s\n" % (len(face), " ".join(map(str, face))) for face in faces)


class Program(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.torus = self.path("torus.ply")
        write_torus(self.torus)

    def path(self, name):
        return os.path.join(self.folder.name, name)

    def write(self, name, text):
        with open(self.path(name), "w") as f:
            f.write(text)
        return self.path(name)

    def run_program(self, *arguments, **more):
        environment = dict(os.environ, **more)
        for name in [k for k, v in more.items() if v is None]:
            del environment[name]
        return subprocess.run([PROGRAM, *arguments], capture_output=True, text=True, env=environment, timeout=120)

    def expect_failure(self, status, words, *arguments, **more):
        """One line on stderr with these words, this status, and no file made or touched."""
        before = self.snapshot()
        run = self.run_program(*arguments, **more)
        self.assertEqual(run.returncode, status, run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1, run.stderr)
        self.assertTrue(run.stderr.startswith("aqr-remesh: "), run.stderr)
        for word in words:
            self.assertIn(word, run.stderr)
        self.assertEqual(run.stdout, "")
        self.assertEqual(before, self.snapshot())

    def snapshot(self):
        return {e.name: (e.stat().st_mtime_ns, e.stat().st_size) for e in os.scandir(self.folder.name)}

    def faces_of(self, path):
        """Number of points and the faces of a .obj file."""
        points, faces = 0, []
        with open(path) as f:
            for line in f:
                if line.startswith("v "):
                    points += 1
                elif line.startswith("f "):
                    faces.append([int(word.split("/")[0]) - 1 for word in line.split()[1:]])
        return points, faces

    def test_target_is_met_and_mesh_is_closed(self):
        run = self.run_program(self.torus, self.path("out.obj"), "--points", "600")
        self.assertEqual((run.returncode, run.stderr, run.stdout), (0, "", ""))
        points, faces = self.faces_of(self.path("out.obj"))
        self.assertLessEqual(abs(points - 600), 30)
        half = {(f[i], f[(i + 1) % len(f)]) for f in faces for i in range(len(f))}
        self.assertEqual(len(half), sum(map(len, faces)))
        self.assertTrue(all((b, a) in half for a, b in half))
        self.assertEqual(points - len(half) // 2 + len(faces), 0)
        self.assertGreater(sum(len(f) == 4 for f in faces) / len(faces), 0.72)

    @unittest.skipUnless(os.environ.get("AQR_SHARED_DATA"), "no shared meshes")
    def test_real_meshes_become_manifold_meshes(self):
        folder = os.environ["AQR_SHARED_DATA"]
        for name in sorted(os.listdir(folder)):
            path = os.path.join(folder, name)
            if not name.endswith(".ply") or os.path.getsize(path) > 6e6:
                continue
            run = self.run_program(path, self.path("out.obj"), "--points", "3000")
            self.assertEqual(run.returncode, 0, name + run.stderr)
            points, faces = self.faces_of(self.path("out.obj"))
            self.assertLess(abs(points - 3000), 151, name)
            half = {(f[i], f[(i + 1) % len(f)]) for f in faces for i in range(len(f))}
            self.assertEqual(len(half), sum(map(len, faces)), name)
            self.assertEqual(len({p for face in faces for p in face}), points, name)
            self.assertGreater(sum(len(f) == 4 for f in faces) / len(faces), 0.72, name)

    def test_every_format_is_written_and_read(self):
        for extension in ("ply", "obj", "stl", "vtk", "vtp"):
            middle = self.path("middle." + extension)
            run = self.run_program(self.torus, middle, "--tolerance", "0.001")
            self.assertEqual((run.returncode, run.stderr), (0, ""), extension)
            run = self.run_program(middle, self.path("again.obj"), "--tolerance", "0.01")
            self.assertEqual(run.returncode, 0, extension + run.stderr)
            self.assertGreater(len(self.faces_of(self.path("again.obj"))[1]), 20, extension)

    def test_equal_bytes_from_repeated_runs_and_any_threads(self):
        results = []
        for threads in ("0", "1", "1", "3"):
            out, lines = self.path("out.vtp"), self.path("lines.vtp")
            run = self.run_program(self.torus, out, "--lines", lines, "--threads", threads)
            self.assertEqual(run.returncode, 0, run.stderr)
            with open(out, "rb") as f, open(lines, "rb") as g:
                results.append(f.read() + g.read())
        self.assertEqual(len(set(results)), 1)

    def test_ports_and_report_are_written(self):
        names = {name: self.path(name + ".vtp") for name in ("lines", "directions", "confidence")}
        arguments = [word for name, file in names.items() for word in ("--" + name, file)]
        run = self.run_program(self.torus, self.path("out.vtp"), "--report", self.path("r.json"), *arguments)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        for name, array in (("lines", "LineType"), ("directions", "MinDirection"), ("confidence", "Confidence")):
            with open(names[name], "rb") as f:
                self.assertIn(('Name="%s"' % array).encode(), f.read())
        with open(self.path("r.json")) as f:
            report = json.load(f)
        self.assertEqual(report["warnings"], [])
        self.assertGreater(report["counts"]["lines"], 10)
        self.assertGreater(report["counts"]["points"], 100)
        self.assertGreater(report["peak_bytes_of_process"], 1e6)
        self.assertGreaterEqual(len(report["stages"]), 5)
        for stage in report["stages"]:
            self.assertGreaterEqual(stage["seconds"], 0)
            self.assertGreaterEqual(stage["peak_bytes"], stage["end_bytes"])

    def test_any_file_name_gives_a_report_that_is_json(self):
        for name in (b'a\ttab\x01 and a "quote" \\.ply', "\u00e9\U0001f600\x7f.ply".encode(), b"\xe9\xff\xed\xa0\x80.ply"):
            file = os.path.join(self.folder.name.encode(), name)
            shutil.copyfile(self.torus, file)
            run = self.run_program(file, self.path("out.vtp"), "--report", self.path("r.json"))
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            with open(self.path("r.json"), encoding="utf-8") as f:
                said = os.path.basename(json.load(f)["input"])
            self.assertIn(said.encode("utf-8"), (name, name.decode("latin-1").encode("utf-8")))

    def test_defects_are_warned_of_once_in_one_line(self):
        write_ply(self.path("flat.ply"), [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (1, 3, 2), (0, 0, 1)])
        run = self.run_program(self.path("flat.ply"), self.path("out.obj"))
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertEqual(run.stderr.count("\n"), 1)
        self.assertIn("warning", run.stderr)
        self.assertIn("1 degenerate", run.stderr)

    def test_a_spacing_that_the_input_cannot_carry_is_warned_of(self):
        write_ply(self.path("flat.ply"), [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)], [(0, 1, 2), (1, 3, 2)])
        for spacing, warned in (("0.0001", True), ("0.1", False)):
            run = self.run_program(self.path("flat.ply"), self.path("out.obj"), "--largest-spacing", spacing)
            self.assertEqual((run.returncode, "largest spacing" in run.stderr), (0, warned), run.stderr)

    def test_wrong_usage_is_refused(self):
        out = self.path("out.vtp")
        self.expect_failure(2, ["INPUT"])
        self.expect_failure(2, ["OUTPUT"], self.torus)
        self.expect_failure(2, ["unexpected"], self.torus, out, "more")
        self.expect_failure(2, ["--frobnicate"], self.torus, out, "--frobnicate")
        self.expect_failure(2, ["--points", "needs a value"], self.torus, out, "--points")
        self.expect_failure(2, ["--points", "whole number"], self.torus, out, "--points", "many")
        self.expect_failure(2, ["--points", "outside"], self.torus, out, "--points", "3")
        self.expect_failure(2, ["--tolerance", "number"], self.torus, out, "--tolerance", "nan")
        self.expect_failure(2, ["--tolerance", "outside"], self.torus, out, "--tolerance", "0.5")

    def test_unreadable_inputs_are_named(self):
        out = self.write("out.vtp", "keep me")
        self.expect_failure(1, ["nowhere.ply", "No such file"], self.path("nowhere.ply"), out)
        self.expect_failure(1, ["folder"], self.folder.name, out)
        self.expect_failure(1, ["torus.xyz", "extensions"], self.write("torus.xyz", "0"), out)
        for extension in ("ply", "obj", "stl", "vtk", "vtp"):
            file = self.write("empty." + extension, "")
            self.expect_failure(1, [file, "empty"], file, out)
            file = self.write("garbage." + extension, "This is no surface.\n")
            self.expect_failure(1, [file], file, out)
        with open(self.torus) as f:
            whole = f.read()
        for share in (0.01, 0.3, 0.99):
            file = self.write("short.ply", whole[: int(share * len(whole))])
            self.expect_failure(1, [file, "too early"], file, out)
        run = self.run_program(self.torus, self.path("binary.ply"))
        self.assertEqual(run.returncode, 0)
        with open(self.path("binary.ply"), "rb") as f:
            data = f.read()
        for share in (0.2, 0.5, 0.99):
            with open(self.path("short.ply"), "wb") as f:
                f.write(data[: int(share * len(data))])
            self.expect_failure(1, [file, "too early"], file, out)

    def files_of_every_kind(self):
        """A small torus in every format, those of text that the program does not write too: bytes by name."""
        torus, files = self.path("small.ply"), {}
        write_torus(torus, 24, 12)
        with open(torus, "rb") as f:
            files["text.ply"] = f.read()
        for extension in ("ply", "obj", "stl", "vtk", "vtp"):
            run = self.run_program(torus, self.path("whole." + extension), "--tolerance", "0.01")
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            with open(self.path("whole." + extension), "rb") as f:
                files["whole." + extension] = f.read()
        rows = files["text.ply"].decode().split("\n")[9:]
        points, faces = rows[:288], [row.split()[1:] for row in rows[288:] if row]
        files["text.vtk"] = "\n".join(
            ["# vtk DataFile Version 3.0", "torus", "ASCII", "DATASET POLYDATA", "POINTS 288 double"] + points
            + ["POLYGONS %d %d" % (len(faces), 4 * len(faces))] + ["3 " + " ".join(face) for face in faces]
        ).encode() + b"\n"
        facet = "facet normal 0 0 0\nouter loop\n%s\nendloop\nendfacet"
        files["text.stl"] = "\n".join(
            ["solid torus"] + [facet % "\n".join("vertex " + points[int(i)] for i in face) for face in faces]
            + ["endsolid torus"]
        ).encode() + b"\n"
        for name, data in files.items():
            with open(self.path(name), "wb") as f:
                f.write(data)
            self.assertEqual(self.run_program(self.path(name), self.path("out.obj")).returncode, 0, name)
        return files

    def test_names_of_materials_do_not_break_the_output(self):
        materials = ["R&D", "a<b", 'a"b', "Terraind\xe6k", "C:\\m", "\u6750\u6599"]
        encoded = [m.encode("latin-1" if m.startswith("Terr") else "utf-8") for m in materials]
        corners = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\n"
        faces = [b"1/1 3/3 2/2", b"1/1 2/2 4/3", b"2/1 3/2 4/3", b"1/1 4/2 3/3"]
        with open(self.path("in.obj"), "wb") as f:
            f.write(b"mtllib x.mtl\n" + corners)
            for i, name in enumerate(encoded):
                f.write(b"usemtl " + name + b"\nf " + faces[i % 4] + b"\n")
        run = self.run_program(self.path("in.obj"), self.path("named.vtp"), "--points", "200")
        self.assertEqual(run.returncode, 0, run.stderr)
        names = self.names_in("named.vtp")
        for name in materials:
            self.assertIn(name, names)
        # Outputs share the arrays of the whole surface.
        with open(self.path("named.vtp"), "rb") as f:
            data = f.read()
        with open(self.path("shared.vtp"), "wb") as f:
            f.write(data.replace(b'"MaterialNames"', b'"R&#38;M"'))
        files = {option: option[2:] + ".vtp" for option in ("--directions", "--confidence", "--lines")}
        options = [word for option, file in files.items() for word in (option, self.path(file))]
        run = self.run_program(self.path("shared.vtp"), self.path("again.vtp"), "--points", "200", *options)
        self.assertEqual(run.returncode, 0, run.stderr)
        for file in ["again.vtp", *files.values()]:
            self.assertIn("R&M", self.names_in(file), file)
        self.assertEqual(self.names_in("again.vtp") - names, {"R&M"})

    def names_in(self, file):
        """Of the arrays of a .vtp file, as XML has them."""
        with open(self.path(file), "rb") as f:
            head = f.read().split(b"<AppendedData")[0]
        return {element.get("Name") for element in xml.etree.ElementTree.fromstring(head + b"</VTKFile>").iter()}

    def expect_refusal(self, name, data):
        with open(self.path(name), "wb") as f:
            f.write(data)
        self.expect_failure(1, [self.path(name)], self.path(name), self.path("out.vtp"))

    def test_files_that_end_too_early_are_named(self):
        self.write("out.vtp", "keep me")
        for name, data in self.files_of_every_kind().items():
            for share in (0.02, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99):
                end = int(share * len(data))
                last_face = data.rfind(b"\nf ", 0, end)
                if name.endswith(".obj") and last_face >= 0:
                    end = data.index(b" ", last_face + 3)  # with three corners left it would be a whole file
                with self.subTest(name=name, share=share):
                    self.expect_refusal("short." + name, data[:end])

    def test_a_header_that_ends_with_the_file_announces_too_much(self):
        head = b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty uchar x\nend_header"
        for n in (1, 100, 200):
            with open(self.path("head.ply"), "wb") as f:
                f.write(head % n)
            self.expect_failure(1, ["ends too early"], self.path("head.ply"), self.path("out.vtp"))

    def test_files_that_lie_about_what_they_hold_are_named(self):
        self.write("out.vtp", "keep me")
        files = self.files_of_every_kind()
        counts = {
            ".ply": (rb"element vertex (\d+)", rb"element face (\d+)"),
            ".vtk": (rb"POINTS (\d+)", rb"POLYGONS (\d+)", rb"POLYGONS \d+ (\d+)"),
            ".vtp": (rb'NumberOfPoints="(\d+)"', rb'NumberOfPolys="(\d+)"'),
        }
        for name, data in files.items():
            for pattern in counts.get(name[-4:], ()):
                found = re.search(pattern, data)
                n = int(found.group(1))
                lies = [0, 1, n - 1, n + 1, 2 * n, 10**6, 10**18, -5]
                if b"Polys" in pattern:  # the reader takes the first of them
                    lies = [0, n + 1, 2 * n, 10**6, 10**18, -5]
                for lie in lies:
                    with self.subTest(name=name, pattern=pattern, lie=lie):
                        self.expect_refusal("lie." + name, data[: found.start(1)] + b"%d" % lie + data[found.end(1) :])
        data = files["whole.stl"]
        n = int.from_bytes(data[80:84], "little")
        for lie in (0, 1, n - 1, n + 1, 2 * n, 2**32 - 1):
            with self.subTest(name="whole.stl", lie=lie):
                self.expect_refusal("lie.stl", data[:80] + lie.to_bytes(4, "little") + data[84:])

    def test_no_value_of_any_option_is_without_a_defined_outcome(self):
        write_torus(self.path("small.ply"), 12, 6)
        ranges = {
            "--points": (4, 2**31 - 1), "--tolerance": (1e-7, 0.1), "--largest-spacing": (1e-4, 1),
            "--anisotropy": (0, 1), "--adaptivity": (0, 1), "--curvature-radius": (0, 0.2), "--smoothing": (0, 1000),
            "--confidence-angle": (0, 90), "--feature-angle": (0.1, 180), "--largest-valence": (4, 64),
            "--seed": (0, 2**31 - 1), "--threads": (0, 1024),
        }
        run = self.run_program("--help")
        for option in re.findall(r"\n  (--\S+) [NFTA] ", run.stdout):
            self.assertIn(option, ranges)
        for option, (low, high) in ranges.items():
            for value in ("nan", "inf", "-inf", "-1", "0", "1e300", "1e-300", "text", "", "1,5", "%g" % low):
                with self.subTest(option=option, value=value):
                    try:
                        good = low <= float(value) <= high
                    except ValueError:
                        good = False
                    whole = option in ("--points", "--smoothing", "--largest-valence", "--seed", "--threads")
                    if not good or (whole and float(value) != int(float(value))):
                        self.expect_failure(2, [option], self.path("small.ply"), self.path("out.obj"), option, value)
                        continue
                    run = self.run_program(self.path("small.ply"), self.path("out.obj"), option, value)
                    self.assertEqual(run.returncode, 0, run.stderr)
                    os.remove(self.path("out.obj"))
        for place in range(6):
            for value in ("nan", "inf", "-inf", "text", ""):
                plane = ["1", "0", "0", "0", "0", "0"]
                plane[place] = value
                with self.subTest(plane=plane):
                    self.expect_failure(
                        2, ["--symmetry"], self.path("small.ply"), self.path("out.obj"), "--symmetry", ",".join(plane))
        for plane in ("1,0,0,1e300,0,0", "1,0,0,-1e300,0,0", "1,0,0,100,0,0"):
            self.expect_failure(1, ["plane" if "100" in plane else "symmetry_origin"], self.path("small.ply"),
                                self.path("out.obj"), "--symmetry", plane)

    def test_unusable_surfaces_are_named(self):
        out = self.write("out.vtp", "keep me")
        square = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0)]
        cases = {
            "nothing": ([], []),
            "points": (square, []),
            "wild": (square, [(0, 1, 9)]),
            "wild_quad": (square, [(0, 1, 3, 9)]),
            "coincident": ([(1, 2, 3)] * 4, [(0, 1, 2), (1, 3, 2)]),
            "nan": (square[:3] + [(math.nan, 1, 0)], [(0, 1, 2), (1, 3, 2)]),
            "infinite": (square[:3] + [(math.inf, 1, 0)], [(0, 1, 2), (1, 3, 2)]),
        }
        for name, (points, faces) in cases.items():
            file = self.path(name + ".ply")
            write_ply(file, points, faces)
            self.expect_failure(1, [file], file, out)
        self.expect_failure(1, [self.torus, "nowhere"], self.torus, out, "--density-array", "nowhere")

    def test_unwritable_outputs_are_named_before_computing(self):
        out = self.path("out.vtp")
        self.expect_failure(1, ["out.xyz"], self.torus, self.path("out.xyz"))
        self.expect_failure(1, ["nowhere", "folder"], self.torus, self.path("nowhere/out.vtp"))
        self.expect_failure(1, ["lines.ply"], self.torus, out, "--lines", self.path("lines.ply"))
        self.expect_failure(1, ["r.txt"], self.torus, out, "--report", self.path("r.txt"))
        self.expect_failure(1, ["p.jpg"], self.torus, out, "--picture", self.path("p.jpg"))

    def expect_old_files_whole(self, folder, before, **how):
        """Writing any format fails with one line, and every file in the folder stays as it was."""
        for extension in (".ply", ".obj", ".stl", ".vtk", ".vtp"):
            out = os.path.join(folder, "out" + extension)
            with open(out, "wb") as f:
                f.write(b"old")
            before["out" + extension] = b"old"
            run = subprocess.run([PROGRAM, self.torus, out], capture_output=True, text=True, timeout=120, **how)
            self.assertEqual((run.returncode, run.stderr.count("\n")), (1, 1), extension + run.stderr)
            self.assertIn(out + " cannot be written: the disk may be full", run.stderr.replace(": cannot", " cannot"))
            now = {}
            for entry in os.scandir(folder):
                with open(entry.path, "rb") as f:
                    now[entry.name] = f.read()
            self.assertEqual(now, before)

    def test_a_disk_that_fills_up_leaves_the_old_files(self):
        # As a full disk does, a limit on the size of files makes writing fail in the middle.
        def limit():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))

        os.mkdir(self.path("limited"))
        self.expect_old_files_whole(self.path("limited"), {}, preexec_fn=limit, restore_signals=False)

    def mount(self, folder, options):
        subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], check=True, capture_output=True)

    def test_a_disk_that_is_full_or_read_only_leaves_the_old_files(self):
        folder = self.path("disk")
        os.mkdir(folder)
        try:
            self.mount(folder, "size=64k")
        except (OSError, subprocess.CalledProcessError):
            self.skipTest("file systems cannot be mounted here")
        try:
            with open(os.path.join(folder, "filler"), "wb") as f:
                f.write(b"x" * 32768)
            self.expect_old_files_whole(folder, {"filler": b"x" * 32768})
            self.mount(folder, "remount,ro")
            run = self.run_program(self.torus, os.path.join(folder, "out.ply"))
            self.assertEqual(run.returncode, 1)
            self.assertIn("Read-only file system", run.stderr)
            with open(os.path.join(folder, "out.ply"), "rb") as f:
                self.assertEqual(f.read(), b"old")
        finally:
            subprocess.run(["umount", folder], check=True)

    def test_no_environment_variable_changes_the_result(self):
        out = self.path("out.vtp")

        def result(environment):
            run = subprocess.run(
                [PROGRAM, self.torus, out], capture_output=True, text=True, timeout=120, env=environment)
            self.assertEqual((run.returncode, run.stderr), (0, ""), environment)
            with open(out, "rb") as f:
                return f.read()

        search = {k: os.environ[k] for k in ("LD_LIBRARY_PATH",) if k in os.environ}
        plain = result(search)
        for name, value in {
            "LC_ALL": "de_DE.UTF-8", "LANG": "tr_TR.UTF-8", "TZ": "Asia/Kathmandu", "HOME": "/nowhere",
            "VTK_SMP_BACKEND_IN_USE": "Sequential", "VTK_SMP_MAX_THREADS": "1", "OMP_NUM_THREADS": "1",
            "VTK_LOGGER_LEVEL": "9", "TMPDIR": "/nowhere", "MALLOC_PERTURB_": "85",
        }.items():
            self.assertEqual(result(dict(search, **{name: value})), plain, name)

    def test_no_display_is_said_before_computing(self):
        self.expect_failure(
            1, ["p.png", "display"], self.torus, self.path("out.vtp"), "--picture", self.path("p.png"), DISPLAY=None
        )

    @unittest.skipUnless(os.environ.get("DISPLAY"), "no display")
    def test_picture_shows_something(self):
        picture = self.path("p.png")
        run = self.run_program(self.torus, self.path("out.vtp"), "--picture", picture)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        with open(picture, "rb") as f:
            data = f.read()
        self.assertEqual(data[:8], b"\x89PNG\r\n\x1a\n")
        self.assertGreater(len(data), 10000)

    def test_help_names_unit_and_default_of_every_option(self):
        run = self.run_program("--help")
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        entries = re.split(r"\n  (?=--)", run.stdout)[1:]
        self.assertGreaterEqual(len(entries), 20)
        for entry in entries:
            if not entry.startswith(("--help", "--version")):
                self.assertIn("default", " ".join(entry.split()), entry)
        self.assertLess(max(map(len, run.stdout.splitlines())), 100)

    def test_every_option_is_heard(self):
        def mesh(*options):
            run = self.run_program(self.torus, self.path("out.obj"), "--tolerance", "0.002", *options)
            self.assertEqual(run.returncode, 0, run.stderr)
            with open(self.path("out.obj")) as f:
                return f.read()

        plain = mesh()
        self.assertEqual(mesh("--seed", "0", "--threads", "2", "--smoothing", "5"), plain)
        for options in (["--tolerance", "0.004"], ["--largest-spacing", "0.02"], ["--curvature-radius", "0.1"]):
            self.assertNotEqual(mesh(*options), plain, options)
        for options in (
            ["--no-features", "--feature-angle", "20", "--no-boundary"],
            ["--no-convex", "--largest-valence", "6", "--no-topology"],
            ["--confidence-angle", "20"],
        ):
            mesh(*options)

    def test_lines_of_the_input_become_edges(self):
        around, across = 80, 40
        with open(self.torus) as f:
            rows = [line.split() for line in f][9:]
        points, faces = rows[: around * across], [row[1:] for row in rows[around * across :]]
        circle = [i % around * across for i in range(around + 1)]
        lines = [circle, [3, 3 + across // 2]]  # the second is no edge
        name = self.write("lines.vtk", "\n".join(
            ["# vtk DataFile Version 3.0", "torus", "ASCII", "DATASET POLYDATA", "POINTS %d double" % len(points)]
            + [" ".join(p) for p in points]
            + ["LINES %d %d" % (len(lines), sum(map(len, lines)) + len(lines))]
            + ["%d %s" % (len(line), " ".join(map(str, line))) for line in lines]
            + ["POLYGONS %d %d" % (len(faces), 4 * len(faces))] + ["3 " + " ".join(face) for face in faces]
            + ["CELL_DATA %d" % (len(lines) + len(faces)), "SCALARS chosen int 1", "LOOKUP_TABLE default", "1", "0"]
            + ["0"] * len(faces)) + "\n")
        report = self.path("report.json")
        runs = ([], False, "2 cells"), (["--lock-lines"], True, "1 of 81"), (["--lock-array", "chosen"], True, "")
        for options, locked, warning in runs:
            run = self.run_program(name, self.path("out.obj"), "--tolerance", "0.003", "--report", report, *options)
            self.assertEqual(run.returncode, 0, run.stderr)
            self.assertIn(warning, run.stderr)
            self.assertEqual(run.stderr == "", warning == "")
            with open(report) as f:
                self.assertEqual(json.load(f)["counts"]["locked_edges"] >= around, locked)
            with open(self.path("out.obj")) as f:
                corners = [tuple(map(float, line.split()[1:])) for line in f if line.startswith("v ")]
            on = [p for p in corners if abs(p[2]) < 1e-6 and math.hypot(*p[:2]) > 3.9]
            self.assertEqual(len(on) > 8, locked, len(on))

    def test_symmetric_output_has_every_point_twice(self):
        def rounded(p, axis, sign):
            return tuple(round(sign * x if k == axis else x, 3) + 0.0 for k, x in enumerate(p))

        for plane, axis in (("y", 1), ("0,0,-2,7,7,0", 2)):
            run = self.run_program(self.torus, self.path("out.obj"), "--tolerance", "0.003", "--symmetry", plane)
            self.assertEqual((run.returncode, run.stderr), (0, ""))
            with open(self.path("out.obj")) as f:
                points = [[float(word) for word in line.split()[1:]] for line in f if line.startswith("v ")]
            self.assertEqual(sorted(rounded(p, axis, 1) for p in points), sorted(rounded(p, axis, -1) for p in points))
        for plane in ("w", "1,2", "0,0,0,0,0,0", "1,0,0,0,0,0,0", "1,0,a,0,0,0"):
            self.expect_failure(2, ["--symmetry"], self.torus, self.path("o.obj"), "--symmetry", plane)

    def test_summary_is_one_line_with_the_figures_of_the_report(self):
        run = self.run_program(self.torus, self.path("out.obj"), "--summary", "--report", self.path("report.json"))
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        with open(self.path("report.json")) as f:
            counts = json.load(f)["counts"]
        points, faces = self.faces_of(self.path("out.obj"))
        self.assertRegex(run.stdout, r"^%d points, %d faces, \d+ quads, tolerance 0\.0005, creases off by 0 " % (
            points, len(faces)))
        self.assertEqual(run.stdout.count("\n"), 1)
        self.assertEqual([counts[k] for k in ("feature_rms", "feature_max", "boundary_rms", "boundary_max")], [0] * 4)

    def test_no_file_is_written_but_those_asked_for(self):
        for name in ("work", "home", "temporary", "out"):
            os.mkdir(self.path(name))
        asked = {name: self.path("out/" + name) for name in ("a.obj", "b.vtp", "c.vtp", "d.vtp", "e.json")}
        environment = dict(os.environ, HOME=self.path("home"), TMPDIR=self.path("temporary"),
                           XDG_CACHE_HOME=self.path("home"), XDG_CONFIG_HOME=self.path("home"))
        run = subprocess.run(
            [os.path.abspath(PROGRAM), self.torus, asked["a.obj"], "--lines", asked["b.vtp"], "--directions", asked["c.vtp"],
             "--confidence", asked["d.vtp"], "--report", asked["e.json"]],
            capture_output=True, text=True, timeout=120, env=environment, cwd=self.path("work"))
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        self.assertEqual(sorted(os.listdir(self.path("out"))), sorted(asked))
        for name in ("work", "home", "temporary"):
            self.assertEqual(os.listdir(self.path(name)), [], name)

    def test_no_network_is_used(self):
        run = self.run_program(self.torus, self.path("out.vtp"), LD_PRELOAD=NO_NETWORK)
        self.assertEqual((run.returncode, run.stderr), (0, ""))
        probe = "import socket; socket.socket(socket.AF_INET)"
        run = subprocess.run(
            [sys.executable, "-c", probe], env=dict(os.environ, LD_PRELOAD=NO_NETWORK), capture_output=True
        )
        self.assertIn(b"network", run.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1] + sys.argv[3:])
