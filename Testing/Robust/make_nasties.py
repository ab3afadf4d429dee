#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Writes surfaces such as scanners and careless exports leave behind, each with one or more defects.

usage: make_nasties.py FOLDER [COUNT [SEED]]

The same seed gives the same files, in the legacy .vtk format because that holds every kind of cell."""
import math
import os
import random
import sys


class Mesh:
    def __init__(self):
        self.points, self.faces, self.strips, self.lines, self.verts = [], [], [], [], []
        self.type = "double"

    def add(self, other, offset=(0, 0, 0), scale=1):
        n = len(self.points)
        self.points += [tuple(scale * x + o for x, o in zip(p, offset)) for p in other.points]
        self.faces += [[i + n for i in f] for f in other.faces]
        self.strips += [[i + n for i in f] for f in other.strips]

    def write(self, path):
        with open(path, "w") as f:
            f.write("# vtk DataFile Version 3.0\nsurface\nASCII\nDATASET POLYDATA\n")
            f.write("POINTS %d %s\n" % (len(self.points), self.type))
            f.writelines("%.17g %.17g %.17g\n" % tuple(p) for p in self.points)
            for name in ("VERTICES", "LINES", "POLYGONS", "TRIANGLE_STRIPS"):
                cells = getattr(self, {"VERTICES": "verts", "POLYGONS": "faces", "TRIANGLE_STRIPS": "strips"}.get(name, "lines"))
                if cells:
                    f.write("%s %d %d\n" % (name, len(cells), sum(map(len, cells)) + len(cells)))
                    f.writelines("%d %s\n" % (len(c), " ".join(map(str, c))) for c in cells)


def grid(nu, nv, place, wrap_u=False, wrap_v=False, mirror=False, quads=False):
    """A grid of triangles; with mirror its last column joins the first upside down."""
    m = Mesh()
    wu, wv = nu if wrap_u else nu + 1, nv if wrap_v else nv + 1
    m.points = [place(i / nu, j / nv) for i in range(wu) for j in range(wv)]

    def at(i, j):
        if mirror and i == nu:
            j = nv - j
        return (i % wu) * wv + j % wv

    for i in range(nu):
        for j in range(nv):
            a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
            m.faces += [[a, b, c, d]] if quads else [[a, b, c], [a, c, d]]
    return m


def on_torus(u, v, q=0.4):
    s, t = 2 * math.pi * u, 2 * math.pi * v
    return ((1 + q * math.cos(t)) * math.cos(s), (1 + q * math.cos(t)) * math.sin(s), q * math.sin(t))


def on_tube(u, v):
    return (math.cos(2 * math.pi * u), math.sin(2 * math.pi * u), 3 * v)


def on_plane(u, v):
    return (u, v, 0)


def on_monkey_saddle(u, v):
    x, y = 2 * u - 1, 2 * v - 1
    return (x, y, x**3 - 3 * x * y * y)


def on_moebius(u, v):
    s, w = 2 * math.pi * u, v - 0.5
    return ((2 + w * math.cos(s / 2)) * math.cos(s), (2 + w * math.cos(s / 2)) * math.sin(s), w * math.sin(s / 2))


def on_klein(u, v):
    s, t = 2 * math.pi * u, 2 * math.pi * v
    r = 2 + math.cos(s / 2) * math.sin(t) - math.sin(s / 2) * math.sin(2 * t)
    return (r * math.cos(s), r * math.sin(s), math.sin(s / 2) * math.sin(t) + math.cos(s / 2) * math.sin(2 * t))


def disk(n, rings):
    m = Mesh()
    m.points = [(0, 0, 0)] + [
        (r / rings * math.cos(2 * math.pi * k / n), r / rings * math.sin(2 * math.pi * k / n), 0)
        for r in range(1, rings + 1)
        for k in range(n)
    ]
    m.faces = [[0, 1 + k, 1 + (k + 1) % n] for k in range(n)]
    for r in range(rings - 1):
        for k in range(n):
            a, b = 1 + r * n + k, 1 + r * n + (k + 1) % n
            m.faces += [[a, a + n, b + n], [a, b + n, b]]
    return m


def sphere(n):
    m = grid(2 * n, n, lambda u, v: (
        math.sin(math.pi * v) * math.cos(2 * math.pi * u), math.sin(math.pi * v) * math.sin(2 * math.pi * u),
        -math.cos(math.pi * v) if 0 < v < 1 else 2 * v - 1), wrap_u=True)
    m.points = [p if abs(p[2]) < 1 else (0, 0, p[2]) for p in m.points]
    return m


def small(points, faces):
    m = Mesh()
    m.points, m.faces = [tuple(map(float, p)) for p in points], faces
    return m


CORNERS = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
BASES = {
    "torus": lambda r: grid(r.randrange(6, 24), r.randrange(4, 12), on_torus, True, True),
    "sphere": lambda r: sphere(r.randrange(3, 14)),
    "tube": lambda r: grid(r.randrange(3, 20), r.randrange(1, 12), on_tube, True),
    "plane": lambda r: grid(r.randrange(1, 15), r.randrange(1, 15), on_plane),
    "quads": lambda r: grid(r.randrange(3, 15), r.randrange(3, 15), on_monkey_saddle, quads=True),
    "saddle": lambda r: grid(2 * r.randrange(2, 8), 2 * r.randrange(2, 8), on_monkey_saddle),
    "disk": lambda r: disk(r.randrange(3, 30), r.randrange(1, 6)),
    "moebius": lambda r: grid(r.randrange(5, 30), r.randrange(1, 6), on_moebius, True, mirror=True),
    "klein": lambda r: grid(r.randrange(8, 24), r.randrange(6, 16), on_klein, False, True),
    "triangle": lambda r: small(CORNERS[:3], [[0, 1, 2]]),
    "quad": lambda r: small([(0, 0, 0), (1, 0, 0), (1, 1, r.choice((0, 0.4))), (0, 1, 0)], [[0, 1, 2, 3]]),
    "tetrahedron": lambda r: small(CORNERS, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]),
}


def any_face(m, r):
    return r.randrange(len(m.faces)) if m.faces else None


def split_apart(m, r):
    """A point of its own for every corner, as .stl files have."""
    points = [m.points[i] for f in m.faces for i in f]
    n, faces = 0, []
    for f in m.faces:
        faces.append(list(range(n, n + len(f))))
        n += len(f)
    m.points, m.faces = points, faces


def repeat_faces(m, r):
    for _ in range(r.randrange(1, 6)):
        f = list(r.choice(m.faces))
        r.shuffle(f)
        m.faces.append(f if len(f) == 3 else f[:3])


def fins(m, r):
    for _ in range(r.randrange(1, 5)):
        f = r.choice(m.faces)
        m.points.append(tuple(x + r.uniform(-0.5, 0.5) for x in m.points[f[0]]))
        m.faces.append([f[0], f[1], len(m.points) - 1])


def touch(m, r):
    """Two points become one: a non-manifold point."""
    a, b = r.randrange(len(m.points)), r.randrange(len(m.points))
    m.points[a] = m.points[b]


def needles(m, r):
    """A triangle is split by a point next to one of its edges."""
    for _ in range(r.randrange(1, 8)):
        k = any_face(m, r)
        f = m.faces[k]
        a, b, c = (m.points[i] for i in f[:3])
        t, e = r.random(), r.choice((0, 1e-6, 1e-9))
        m.points.append(tuple((1 - t) * x + t * y + e * (z - x) for x, y, z in zip(a, b, c)))
        n = len(m.points) - 1
        m.faces[k] = [n, f[1], f[2]]
        m.faces += [[f[0], n, f[2]], [f[0], f[1], n]]


def turn_some(m, r):
    for f in m.faces:
        if r.random() < 0.3:
            f.reverse()


def no_area(m, r):
    for _ in range(r.randrange(1, 6)):
        a, b = r.randrange(len(m.points)), r.randrange(len(m.points))
        m.faces.append([a, b, r.choice((a, b))])


def isolated_points(m, r):
    m.points += [tuple(r.uniform(-2, 2) for _ in range(3)) for _ in range(r.randrange(1, 9))]


def holes(m, r):
    for _ in range(r.randrange(1, 8)):
        if len(m.faces) > 1:
            m.faces.pop(any_face(m, r))


def crumbs(m, r):
    for _ in range(r.randrange(1, 6)):
        m.add(r.choice((BASES["triangle"], BASES["tetrahedron"], BASES["quad"]))(r),
              tuple(r.uniform(-2, 2) for _ in range(3)), 10 ** r.uniform(-5, -0.5))


def another(m, r):
    m.add(BASES[r.choice(sorted(BASES))](r), tuple(r.uniform(-1, 1) for _ in range(3)), 10 ** r.uniform(-2, 0.5))


def double_sheet(m, r):
    copy = Mesh()
    copy.points, copy.faces = list(m.points), [f[::-1] for f in m.faces]
    m.add(copy, (0, 0, r.choice((1e-3, 1e-6, 1e-12))))


def rough(m, r):
    e = 10 ** r.uniform(-6, -0.5)
    m.points = [tuple(x + r.gauss(0, e) for x in p) for p in m.points]


def squeeze(m, r):
    axis, factor = r.randrange(3), r.choice((1e-6, 1e-3, 1e3))
    m.points = [tuple(x * factor if k == axis else x for k, x in enumerate(p)) for p in m.points]


def far_away(m, r):
    offset = [r.choice((0, 1e3, -1e6, 1e9)) for _ in range(3)]
    m.points = [tuple(x + o for x, o in zip(p, offset)) for p in m.points]


def tiny_or_huge(m, r):
    factor = r.choice((1e-12, 1e12, 1e-30, 1e30))
    m.points = [tuple(factor * x for x in p) for p in m.points]


def whole_numbers(m, r):
    m.points = [tuple(round(10 * x) / 10 for x in p) for p in m.points]


def floats(m, r):
    m.type = "float"


def mixed_cells(m, r):
    n = len(m.points)
    m.verts += [[r.randrange(n)] for _ in range(3)]
    m.lines += [[r.randrange(n) for _ in range(r.randrange(2, 6))]]


def strips(m, r):
    n = len(m.points)
    m.points += [(4 + 0.1 * k, k % 2, 0.01 * k * k) for k in range(r.randrange(4, 20))]
    m.strips.append(list(range(n, len(m.points))))


def polygon(m, r):
    """A star, concave and mostly not in one plane."""
    n, k = len(m.points), r.randrange(5, 40)
    for i in range(k):
        a, q = 2 * math.pi * i / k, r.uniform(0.2, 1)
        m.points.append((3 + q * math.cos(a), q * math.sin(a), r.choice((0, r.uniform(-0.3, 0.3)))))
    m.faces.append(list(range(n, n + k)))


def soup(m, r):
    n = len(m.points)
    m.faces += [[r.randrange(n) for _ in range(3)] for _ in range(r.randrange(1, 30))]


def not_finite(m, r):
    k = r.randrange(len(m.points))
    m.points[k] = (m.points[k][0], r.choice((math.nan, math.inf, -math.inf)), 0.0)


def wild_index(m, r):
    m.faces.append([0, 1, len(m.points) + r.choice((0, 1, 10**6))])


def no_faces(m, r):
    m.faces, m.strips = [], []


def one_place(m, r):
    m.points = [(1.0, 2.0, 3.0)] * len(m.points)


def one_line(m, r):
    m.points = [(p[0] + p[1], 2 * (p[0] + p[1]), 0.0) for p in m.points]


DEFECTS = [split_apart, repeat_faces, fins, touch, needles, turn_some, no_area, isolated_points, holes, crumbs, another,
           double_sheet, rough, squeeze, far_away, tiny_or_huge, whole_numbers, floats, mixed_cells, strips, polygon, soup]
REFUSED = [not_finite, wild_index, no_faces, one_place, one_line]


def make(seed, number):
    r = random.Random(seed * 1000003 + number)
    base = sorted(BASES)[number % len(BASES)]
    m = BASES[base](r)
    defects = [] if number < len(BASES) else r.sample(DEFECTS, r.choice((1, 1, 2, 3, 5)))
    if number % 20 == 19:
        defects.append(r.choice(REFUSED))
    for defect in defects:
        defect(m, r)
    return m, "-".join(["%05d" % number, base] + [d.__name__ for d in defects])


def main():
    folder, count, seed = sys.argv[1], int((sys.argv[2:] or ["2000"])[0]), int((sys.argv[3:] or ["1"])[0])
    os.makedirs(folder, exist_ok=True)
    for number in range(count):
        mesh, name = make(seed, number)
        mesh.write(os.path.join(folder, name + ".vtk"))


if __name__ == "__main__":
    main()
