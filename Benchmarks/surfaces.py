# SPDX-License-Identifier: BSD-3-Clause
"""Surfaces that the benchmarks make themselves, with their exact principal directions.

Each is the zero set of a function; its Hessian, by differences, gives the shape operator (Goldman 2005)."""
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkCleanPolyData, vtkFlyingEdges3D


def poly_data(points, triangles):
    result, at, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    at.SetData(numpy_to_vtk(np.ascontiguousarray(points, np.float64), deep=1))
    cells.SetData(3, numpy_to_vtkIdTypeArray(np.ascontiguousarray(triangles, np.int64).ravel(), deep=1))
    result.SetPoints(at)
    result.SetPolys(cells)
    return result


def points_of(surface):
    return vtk_to_numpy(surface.GetPoints().GetData()).astype(np.float64)


def grid(u, v, closed_u, closed_v):
    """Triangles of a grid of u times v points, in the order of their rows."""
    i, j = np.meshgrid(np.arange(u if closed_u else u - 1), np.arange(v if closed_v else v - 1), indexing="ij")

    def at(a, b):
        return ((a % u) * v + b % v).ravel()

    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
    return np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def bumpy_torus(faces):
    """The torus of benchmark-stages: curvature varies along and across it."""
    across = max(8, int((faces / 6) ** 0.5))
    u, v = np.meshgrid(np.arange(3 * across) / (3 * across), np.arange(across) / across, indexing="ij")
    u, v = 2 * np.pi * u.ravel(), 2 * np.pi * v.ravel()
    tube = 1 + 0.2 * np.cos(5 * u) + 0.1 * np.sin(4 * v)
    ring = 3 + tube * np.cos(v)
    return poly_data(np.stack([ring * np.cos(u), ring * np.sin(u), tube * np.sin(v)], 1),
                     grid(3 * across, across, True, True))


def gradient(f, p, h):
    steps = h * np.eye(3)
    return np.stack([(f(p + s) - f(p - s)) / (2 * h) for s in steps], 1)


def hessian(f, p, h):
    steps = h * np.eye(3)
    return np.stack([(gradient(f, p + s, h) - gradient(f, p - s, h)) / (2 * h) for s in steps], 2)


def principal(f, p, h=1e-3):
    """Curvatures and directions of the two principal directions at points of the zero set: (n, 2), (n, 2, 3)."""
    g = gradient(f, p, h)
    size = np.linalg.norm(g, axis=1)
    n = g / size[:, None]
    across = np.eye(3) - n[:, :, None] * n[:, None, :]
    shape = across @ hessian(f, p, h) @ across / size[:, None, None]
    k, d = np.linalg.eigh(shape + 1e6 * n[:, :, None] * n[:, None, :])  # the normal's own value is out of the way
    return k[:, :2], np.swapaxes(d, 1, 2)[:, :2]


def contour(f, low, high, cells):
    """The zero set as marching triangles on a lattice, moved onto it; the lattice leaves slivers, as scans do."""
    step = max(b - a for a, b in zip(low, high)) / cells
    size = [int(round((b - a) / step)) + 1 for a, b in zip(low, high)]
    z, y, x = np.meshgrid(*[a + step * np.arange(n) for a, n in reversed(list(zip(low, size)))], indexing="ij")
    values = f(np.stack([x.ravel(), y.ravel(), z.ravel()], 1))
    image = vtkImageData()
    image.SetDimensions(size)
    image.SetSpacing(step, step, step)
    image.SetOrigin(low)
    image.GetPointData().SetScalars(numpy_to_vtk(values, deep=1))
    edges, clean = vtkFlyingEdges3D(), vtkCleanPolyData()
    edges.SetInputData(image)
    edges.SetValue(0, 0.0)
    edges.ComputeNormalsOff()
    edges.ComputeScalarsOff()
    clean.SetInputConnection(edges.GetOutputPort())
    clean.Update()
    p = points_of(clean.GetOutput())
    for _ in range(4):
        g = gradient(f, p, 1e-5)
        p = p - (f(p) / np.maximum((g * g).sum(1), 1e-12))[:, None] * g
    return poly_data(p, vtk_to_numpy(clean.GetOutput().GetPolys().GetConnectivityArray()).reshape(-1, 3))


def smooth_minimum(a, b, radius):
    """The union of two solids with a fillet of about that radius between them."""
    part = np.maximum(radius - np.abs(a - b), 0) / radius
    return np.minimum(a, b) - part ** 3 * radius / 6


def smooth_maximum(a, b, radius):
    return -smooth_minimum(-a, -b, radius)


def box(p, half, rounding):
    q = np.abs(p) - np.asarray(half)
    return smooth_maximum(smooth_maximum(q[:, 0], q[:, 1], rounding), q[:, 2], rounding)


def tube(p, axis, radius):
    return np.linalg.norm(np.delete(p, axis, 1), axis=1) - radius


def bracket(p):
    """A plate with a boss, a bore through both, and two holes for bolts; all edges have fillets."""
    plate = box(p, (1.2, 0.7, 0.15), 0.1)
    boss = smooth_maximum(tube(p, 2, 0.45), np.abs(p[:, 2] - 0.3) - 0.45, 0.1)
    solid = smooth_minimum(plate, boss, 0.25)
    for centre, radius in (((0, 0, 0), 0.25), ((0.85, 0, 0), 0.15), ((-0.85, 0, 0), 0.15)):
        solid = smooth_maximum(solid, -tube(p - centre, 2, radius), 0.08)
    return solid


def organic(p):
    """Balls grown together."""
    balls = (((0, 0, 0), 0.6), ((0.8, 0.1, 0.2), 0.4), ((-0.6, 0.5, 0.1), 0.35), ((0.2, -0.8, -0.1), 0.3),
             ((-0.2, 0.1, 0.8), 0.3), ((1.3, 0.3, 0.5), 0.2))
    result = np.full(len(p), np.inf)
    for centre, radius in balls:
        result = smooth_minimum(result, np.linalg.norm(p - centre, axis=1) - radius, 0.35)
    return result


def torus(p):
    return np.hypot(np.hypot(p[:, 0], p[:, 1]) - 1, p[:, 2]) - 0.4


def ellipsoid(p):
    return (p[:, 0] / 1.0) ** 2 + (p[:, 1] / 0.7) ** 2 + (p[:, 2] / 0.4) ** 2 - 1


def waves(p):
    return p[:, 2] - 0.2 * np.sin(3 * p[:, 0]) * np.cos(2 * p[:, 1]) - 0.05 * np.cos(5 * p[:, 0] + 2 * p[:, 1])


def wavy_sheet(n):
    rng = np.random.default_rng(1)
    x, y = np.meshgrid(np.linspace(-1.5, 1.5, n), np.linspace(-1, 1, n), indexing="ij")
    inside = np.ones((n, n))
    inside[[0, -1]] = inside[:, [0, -1]] = 0
    x, y = (a + 0.3 * s * inside * rng.uniform(-1, 1, (n, n)) for a, s in ((x, 3 / n), (y, 2 / n)))
    p = np.stack([x.ravel(), y.ravel(), np.zeros(n * n)], 1)
    p[:, 2] = -waves(p)
    return poly_data(p, grid(n, n, False, False))


# name: the function, and what makes the surface
ALL = {
    "bracket": (bracket, lambda: contour(bracket, (-1.4, -0.9, -0.4), (1.4, 0.9, 1.0), 160)),
    "organic": (organic, lambda: contour(organic, (-1.3, -1.4, -0.9), (1.8, 1.2, 1.4), 120)),
    "sheet": (waves, lambda: wavy_sheet(160)),
    "torus": (torus, lambda: contour(torus, (-1.5, -1.5, -0.5), (1.5, 1.5, 0.5), 120)),
    "ellipsoid": (ellipsoid, lambda: contour(ellipsoid, (-1.1, -0.8, -0.5), (1.1, 0.8, 0.5), 120)),
}
