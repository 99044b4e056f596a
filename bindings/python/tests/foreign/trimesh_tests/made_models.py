"""Shapes of the kind that trimesh's tests load from files, which its source archive leaves out.

Plates, rims, bosses, rings and rounded edges: what a CAD program exports, with the points of its
flat faces in one plane and those of its straight edges on one line, but for what a turn rounds.
Coordinates are those of single precision, as STL files hold them.
"""

import numpy as np
import trimesh
from trimesh import creation
from trimesh.transformations import rotation_matrix, translation_matrix

SIDEWAYS = rotation_matrix(np.pi / 2, [1, 0, 0])


def _cylinder(radius, height, sections, x, y, z, turn=None):
    """With no vertex where its surface touches the planes of a box."""
    place = translation_matrix([x, y, z])
    if turn is not None:
        place = place @ turn
    place = place @ rotation_matrix(np.pi / sections, [0, 0, 1])
    return creation.cylinder(radius=radius, height=height, sections=sections, transform=place)


def _loft(low, high):
    """Between two convex polygons of as many corners, counter-clockwise seen from the second."""
    n = len(low)
    around = [(i, (i + 1) % n) for i in range(n)]
    sides = [f for i, j in around for f in ((i, j, n + j), (i, n + j, n + i))]
    fan = [(0, i, i + 1) for i in range(1, n - 1)]
    caps = [(a, c, b) for a, b, c in fan] + [(n + a, n + b, n + c) for a, b, c in fan]
    return trimesh.Trimesh(vertices=[*low, *high], faces=sides + caps)


def _single_precision(*parts):
    mesh = trimesh.util.concatenate(parts)
    mesh.vertices = mesh.vertices.astype(np.float32).astype(np.float64)
    return mesh


def box():
    return _single_precision(creation.box(extents=[10, 7, 3]).subdivide().subdivide())


def wallhole():
    """A wall with a grid of points on its faces, and a ridge with flat slopes along its top."""
    wall = creation.box(bounds=[[0, 0, -10], [10, 10, 0]]).subdivide()
    foot = [[0, 10, 0], [5, 10, 0], [10, 10, 0], [10, 10, -10], [5, 10, -10], [0, 10, -10]]
    top = [[2, 13, -4], [5, 13, -4], [8, 13, -4], [8, 13, -6], [5, 13, -6], [2, 13, -6]]
    return _single_precision(wall, _loft(foot, top))


def tray_bottom():
    """A plate with rounded corners and a bush in a hole, and points along its straight edges."""
    x, y, z, rim = 273.8, 3.175, 326.2, 7.14375
    corners = [
        _cylinder(rim, y, 48, i * x / 2, 0, j * z / 2, SIDEWAYS) for i in (-1, 1) for j in (-1, 1)
    ]
    return _single_precision(
        creation.box(extents=[x, y, z]).subdivide().subdivide(),
        creation.box(extents=[x + 2 * rim, y, z]).subdivide(),
        creation.box(extents=[x, y, z + 2 * rim]).subdivide(),
        creation.annulus(7.5, 9.5, y, sections=32, transform=SIDEWAYS),
        *corners,
    )


def featuretype():
    """A plate with a rounded end, two lobes and a ring."""
    return _single_precision(
        creation.box(extents=[5, 3, 0.5]).subdivide().subdivide(),
        _cylinder(0.25, 3, 32, -2.5, 0, 0, SIDEWAYS),
        creation.annulus(0.5, 0.75, 0.75, sections=64, transform=translation_matrix([1, 0, 0.375])),
        _cylinder(0.75, 0.5, 64, 2.5, 0.75, 0),
        _cylinder(0.75, 0.5, 64, 2.5, -0.75, 0),
    )


def fandisk():
    """A quarter of stepped, chamfered discs."""
    angles = np.linspace(0, np.pi / 2, 25)

    def sector(radius, z):
        rim = np.column_stack([radius * np.cos(angles), radius * np.sin(angles)])
        flat = np.vstack([[0, 0], [radius / 2, 0], rim, [0, radius / 2]])
        return np.column_stack([flat, np.full(len(flat), z)])

    profile = [(1, 0), (1.2, 0.05), (1.2, 0.3), (1.1, 0.4)], [(0.6, 0.41), (0.6, 0.7), (0.5, 0.75)]
    sectors = [[sector(*step) for step in part] for part in profile]
    return _single_precision(*(_loft(*pair) for part in sectors for pair in zip(part, part[1:])))


CAD = {f.__name__: f for f in (box, fandisk, featuretype, tray_bottom, wallhole)}


def knot():
    """A tube around a trefoil."""
    u = np.linspace(0, 2 * np.pi, 96, endpoint=False)[:, np.newaxis]
    line = np.hstack([np.sin(u) + 2 * np.sin(2 * u), np.cos(u) - 2 * np.cos(2 * u), -np.sin(3 * u)])
    ahead = trimesh.unitize(np.roll(line, -1, axis=0) - np.roll(line, 1, axis=0))
    aside = trimesh.unitize(np.cross(ahead, line))
    above = np.cross(ahead, aside)
    v = np.linspace(0, 2 * np.pi, 12, endpoint=False)
    tube = [line + 0.4 * (np.cos(t) * aside + np.sin(t) * above) for t in v]
    near = np.arange(96 * 12).reshape(12, 96)
    far, side = np.roll(near, -1, axis=1), np.roll(near, -1, axis=0)
    corner = np.roll(side, -1, axis=1)
    halves = (near, far, corner), (near, corner, side)
    faces = np.vstack([np.stack(half, axis=-1).reshape(-1, 3) for half in halves])
    mesh = trimesh.Trimesh(vertices=np.vstack(tube), faces=faces)
    mesh.fix_normals()
    return mesh


def not_convex():
    mesh = creation.icosphere()
    mesh.update_faces(np.arange(len(mesh.faces)) > 4)
    return mesh


#: By the names of trimesh's files.
MODELS = {
    "large_block.STL": box,
    "featuretype.STL": featuretype,
    "quadknot.obj": knot,
    "unit_cube.STL": creation.box,
    "1002_tray_bottom.STL": tray_bottom,
    "fandisk.obj": fandisk,
    "wallhole.obj": wallhole,
    "not_convex.obj": not_convex,
}
