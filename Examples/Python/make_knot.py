#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Write a knotted tube of changing, oval section to a .ply file.

usage: make_knot.py FILE.ply [POINTS_ALONG POINTS_AROUND]"""
import math
import struct
import sys


def along(t):
    """The curve: a trefoil on a torus."""
    r = 2 + 0.65 * math.cos(3 * t)
    return (r * math.cos(2 * t), r * math.sin(2 * t), 0.8 * math.sin(3 * t))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(a):
    length = math.sqrt(sum(x * x for x in a))
    return tuple(x / length for x in a)


def point(t, angle):
    step = 1e-3
    here = along(t)
    tangent = unit(tuple(a - b for a, b in zip(along(t + step), along(t - step))))
    # Outward from the ring about which the curve winds: a frame that turns evenly.
    outward = (here[0] - 2 * math.cos(2 * t), here[1] - 2 * math.sin(2 * t), here[2])
    binormal = unit(cross(tangent, outward))
    normal = cross(binormal, tangent)
    width, height = 0.36 + 0.1 * math.cos(6 * t), 0.36 - 0.1 * math.cos(6 * t)
    return tuple(
        h + width * math.cos(angle) * n + height * math.sin(angle) * b for h, n, b in zip(here, normal, binormal)
    )


def main(path, n=600, m=60):
    n, m = int(n), int(m)
    with open(path, "wb") as f:
        f.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % (n * m))
        f.write(b"property float x\nproperty float y\nproperty float z\n")
        f.write(b"element face %d\nproperty list uchar int vertex_indices\nend_header\n" % (2 * n * m))
        for i in range(n):
            for j in range(m):
                f.write(struct.pack("<3f", *point(2 * math.pi * i / n, 2 * math.pi * j / m)))
        for i in range(n):
            for j in range(m):
                a, b = i * m + j, (i + 1) % n * m + j
                c, d = (i + 1) % n * m + (j + 1) % m, i * m + (j + 1) % m
                f.write(struct.pack("<B3iB3i", 3, a, b, c, 3, a, c, d))


if __name__ == "__main__":
    main(*sys.argv[1:])
