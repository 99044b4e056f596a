"""Every mesh that the program writes by default, read by other people's programs.

    python3 -m venv readers && readers/bin/pip install trimesh pyvista open3d pymeshlab
    readers/bin/python tests/files/mesh_readers.py build/release/bin/cullhull [PACKAGE ...]

Without PACKAGE every package that is installed reads; at least one has to be. Each file must be
read without an exception, and the triangles that come back must have the area that was written.
"""

from __future__ import annotations

import importlib
import itertools
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

CUBE = [[0, 3], [0, 3], [0, 3]]


def prism(corners: int) -> list[list[float]]:
    """Two polygons with more corners than a byte counts, and a belt of quadrilaterals."""
    turns = [2 * math.pi * i / corners for i in range(corners)]
    return [[math.cos(t), math.sin(t), z] for z in (0, 1) for t in turns]


def cube_grid(width: int, dimension: int) -> list[list[float]]:
    return [list(map(float, p)) for p in itertools.product(range(width), repeat=dimension)]


POINTS = {
    "grid of a cube": cube_grid(4, 3),
    "pyramid": [[0, 0, 0], [2, 0, 0], [2, 2, 0], [0, 2, 0], [1, 1, 3]],
    "tetrahedron": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
    "prism": prism(300),
    "square in space": [[0, 0, 5], [2, 0, 5], [2, 2, 5], [0, 2, 5], [1, 1, 5]],
    "triangle in space": [[0, 0, 1], [2, 0, 2], [2, 2, 3]],
    "grid of a square": cube_grid(4, 2),
    "polygon": [p[:2] for p in prism(400)[:400]],
}
NO_AREA = {
    "segment in space": [[0, 0, 0], [1, 2, 3], [2, 4, 6]],
    "segment": [[0, 0], [1, 2], [2, 4]],
    "point": [[1, 2, 3]],
}
ENDINGS = ["ply", "off", "obj", "stl", "glb", "vtp"]
REGION = {
    "type": "Polygon",
    "coordinates": [
        [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4], [0, 0]],
        [[0.25, 0.25], [0.25, 0.5], [0.5, 0.5], [0.5, 0.25], [0.25, 0.25]],
    ],
}


def area_of(vertices: np.ndarray, triangles: np.ndarray) -> float:
    corners = np.asarray(vertices, float)[np.asarray(triangles, int).reshape(-1, 3)]
    sides = corners[:, 1:] - corners[:, :1]
    return float(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2)


def with_trimesh(path: str) -> float | None:
    import trimesh

    if path.endswith(".vtp"):
        return None
    mesh = trimesh.load_mesh(path, process=False)
    return area_of(mesh.vertices, mesh.faces)


def with_pyvista(path: str) -> float | None:
    import pyvista

    if path.endswith(".off"):  # needs meshio, which is no part of it
        return None
    found = pyvista.read(path)
    if isinstance(found, pyvista.MultiBlock):
        found = found.combine()
    found = found.extract_surface(algorithm="dataset_surface") if not isinstance(found, pyvista.PolyData) else found
    found = found.triangulate()
    return area_of(found.points, found.faces.reshape(-1, 4)[:, 1:])


def with_open3d(path: str) -> float | None:
    import open3d

    if path.endswith(".vtp"):
        return None
    with open3d.utility.VerbosityContextManager(open3d.utility.VerbosityLevel.Error):
        mesh = open3d.io.read_triangle_mesh(path)
    return area_of(mesh.vertices, mesh.triangles)


def with_pymeshlab(path: str) -> float | None:
    import pymeshlab

    if path.endswith(".vtp"):
        return None
    found = pymeshlab.MeshSet()
    found.load_new_mesh(path)
    mesh = found.current_mesh()
    return area_of(mesh.vertex_matrix(), mesh.face_matrix())


READERS = {
    "trimesh": with_trimesh,
    "pyvista": with_pyvista,
    "open3d": with_open3d,
    "pymeshlab": with_pymeshlab,
}


class Files:
    """What the program writes into a folder, each with the area that it should have."""

    def __init__(self, program: str, folder: Path) -> None:
        self.program, self.folder = program, folder
        self.found: list[tuple[str, Path, float]] = []

    def points(self, rows: list[list[float]]) -> str:
        path = self.folder / "points.txt"
        path.write_text("".join(" ".join(map(repr, row)) + "\n" for row in rows))
        return str(path)

    def write(self, what: str, area: float, *arguments: str, endings: list[str]) -> None:
        for ending in endings:
            path = self.folder / f"{len(self.found)}.{ending}"
            subprocess.run([self.program, *arguments, "-q", "-o", str(path)], check=True)
            self.found.append((f"{what}, {' '.join(arguments[:1])} .{ending}", path, area))

    def hull_area(self, path: str) -> float:
        told = subprocess.run(
            [self.program, "hull", path, "--json"], check=True, capture_output=True, text=True
        )
        report = json.loads(told.stdout)
        return float(report["area"])


def written(program: str, folder: Path) -> list[tuple[str, Path, float]]:
    files = Files(program, folder)
    for name, rows in POINTS.items():
        path = files.points(rows)
        files.write(name, files.hull_area(path), "hull", path, endings=ENDINGS)
    for name, rows in NO_AREA.items():
        path = files.points(rows)
        files.write(name, 0.0, "hull", path, endings=["ply", "off", "obj", "vtp"])
    path = files.points(cube_grid(4, 2))
    files.write("grid of a square", 9.0, "delaunay", path, endings=ENDINGS)
    files.write("grid of a square", 9.0, "alpha", path, "--alpha", "9", endings=ENDINGS)
    cells = ["ply", "off", "obj", "vtp"]
    files.write("grid of a square", 16.0, "voronoi", path, "--box", "-.5,-.5,3.5,3.5", endings=cells)
    region = folder / "region.geojson"
    region.write_text(json.dumps(REGION))
    files.write("clipped", 6.9375, "voronoi", path, "--clip", str(region), endings=["ply", "off"])
    path = files.points(cube_grid(3, 3))
    files.write("grid of a cube", 24.0, "alpha", path, "--alpha", "9", endings=ENDINGS)
    box = ("--box", "-.5,-.5,-.5,2.5,2.5,2.5")
    files.write("grid of a cube", 27.0 * 6, "voronoi", path, *box, endings=cells)
    return files.found


def main(program: str, names: list[str]) -> int:
    chosen = names or list(READERS)
    readers = {}
    for name in chosen:
        try:
            importlib.import_module(name)
        except ImportError as error:
            if names:
                raise
            print(f"{name} is absent: {error}")
            continue
        readers[name] = READERS[name]
    if not readers:
        print("no reader is installed")
        return 1
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for what, path, area in written(program, Path(folder)):
            for name, reader in readers.items():
                try:
                    found = reader(str(path))
                except Exception as error:  # whatever it raises
                    failed += 1
                    print(f"{what}: {name} raises {type(error).__name__}: {error}")
                    continue
                if found is not None and not abs(found - area) <= 1e-5 * (1 + area):
                    failed += 1
                    print(f"{what}: {name} finds an area of {found}, not {area}")
    print(f"{failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], sys.argv[2:]))
