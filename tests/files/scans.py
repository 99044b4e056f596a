"""LAS files of every version and point format that laspy writes, with scales and offsets of their
own: every command gives what SciPy and shapely give for laspy's coordinates.

scans.py PROGRAM
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

import laspy
import numpy as np
import shapely
from scipy.spatial import ConvexHull, Delaunay, Voronoi
from shapely.geometry import shape

PROGRAM = ""
#: 1.0 has the point formats of 1.1; laspy writes the latter.
FORMATS = {"1.0": (0, 1), "1.1": (0, 1), "1.2": range(4), "1.3": range(6), "1.4": range(11)}
SCALES = (0.01, 0.001, 0.1, 0.25, 0.02, 0.0003048, 0.05, 1.0, 0.0013371234567890123)
OFFSETS = (0.0, 484000.0, 5400000.5, -12.25, 1e6, -300.0, 635581.07, 1.2345678901234567)


def run(*words):
    done = subprocess.run([PROGRAM, *map(str, words)], capture_output=True, timeout=120)
    assert done.returncode == 0, (words, done.stderr.decode())
    return done.stdout


def write_scan(path, numbers, version, point_format, scales, offsets, classes):
    written = "1.1" if version == "1.0" else version
    header = laspy.LasHeader(point_format=point_format, version=written)
    header.scales, header.offsets = scales, offsets
    scan = laspy.LasData(header)
    scan.X, scan.Y, scan.Z = numbers.T
    scan.classification = classes
    scan.write(str(path))
    if version == "1.0":
        with open(path, "r+b") as file:
            file.seek(25)
            file.write(b"\0")
    return np.column_stack([scan.x, scan.y, scan.z])


def cells_of(path):
    return {tuple(sorted(c)) for c in json.loads(path.read_text())["cells"]}


def simplices_of(points):
    return {tuple(sorted(map(int, c))) for c in Delaunay(points - points[0]).simplices}


def radii(points, triangles):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    sides = [np.linalg.norm(p - q, axis=1) for p, q in ((a, b), (b, c), (c, a))]
    u, v = b - a, c - a
    areas = np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]) / 2
    return sides[0] * sides[1] * sides[2] / (4 * areas), areas


class Scans(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.random = np.random.default_rng(7)

    def near(self, a, b, share=1e-9):
        np.testing.assert_allclose(a, b, rtol=share)

    def same(self, a, b):
        """But for laspy's two roundings: of the product, and of the sum with the offset."""
        np.testing.assert_allclose(a, b, rtol=2.0**-51, atol=2.0**-52 * max(OFFSETS))

    def test_fifty_files_agree_with_laspy(self):
        pairs = [(v, f) for v, formats in FORMATS.items() for f in formats]
        for i in range(50):
            version, point_format = pairs[i % len(pairs)]
            scales = self.random.choice(SCALES, 3, replace=False)
            offsets = self.random.choice(OFFSETS, 3)
            with self.subTest(i=i, version=version, point_format=point_format, scales=scales):
                numbers = self.random.integers(-(10**6), 10**6, (400, 3)).astype(np.int32)
                classes = self.random.integers(0, 4, 400).astype(np.uint8)
                path = self.folder / "scan.las"
                points = write_scan(path, numbers, version, point_format, scales, offsets, classes)
                self.points_agree(path, points)
                self.hulls_agree(path, points)
                self.groups_agree(path, points, classes)
                self.triangulations_agree(path, points)
                self.shapes_agree(path, points)

    def points_agree(self, path, points):
        out = self.folder / "kept.csv"
        run("cull", path, "--cull", "none", "--points", out)
        with open(out) as file:
            rows = np.array([[float(x) for x in row] for row in list(csv.reader(file))[1:]])
        self.same(rows, points)
        axes = json.loads(run("info", path, "--json"))["axes"]
        self.same([a["least"] for a in axes], points.min(0))
        self.same([a["greatest"] for a in axes], points.max(0))

    def hulls_agree(self, path, points):
        out = self.folder / "hull.json"
        expected = ConvexHull(points - points[0])
        for stream in ("off", "on"):
            report = json.loads(run("hull", path, "-o", out, "--stream", stream, "--certify", "--json"))
            self.near([report["area"], report["volume"]], [expected.area, expected.volume])
            hull = json.loads(out.read_text())
            self.assertEqual(sorted(hull["vertices"]), sorted(expected.vertices))
            self.same(hull["vertex_coordinates"], points[hull["vertices"]])
            planes = np.array(hull["facet_planes"])
            heights = planes[:, :3] @ (points - points[0]).T + (
                planes[:, :3] @ points[0] + planes[:, 3]
            )[:, None]
            self.assertLess(heights.max(), 1e-7)
            self.assertLess(np.abs(heights.max(1)).max(), 1e-7)
            run("certify", path, out, "--stream", stream)
        frames = json.loads(run("track", path, path, "--json"))["frames"]
        self.near(frames[1]["volume"], expected.volume)
        figures = self.folder / "figures.json"
        run("view", path, "-o", self.folder / "page.html", f"--json={figures}")
        self.near(json.loads(figures.read_text())["volume"], expected.volume)

    def groups_agree(self, path, points, classes):
        out = self.folder / "groups.geojson"
        run("hull", path, "--by", "classification", "--columns", "x,y", "-o", out)
        for feature in json.loads(out.read_text())["features"]:
            chosen = points[classes == feature["properties"]["classification"], :2]
            hull = shapely.MultiPoint(chosen - points[0, :2]).convex_hull
            self.near(feature["properties"]["area"], hull.area)
            self.near(feature["properties"]["perimeter"], hull.length)

    def triangulations_agree(self, path, points):
        out = self.folder / "cells.json"
        run("delaunay", path, "-o", out, "--certify")
        self.assertEqual(cells_of(out), simplices_of(points))
        run("delaunay", path, "--columns", "x,y", "-o", out)
        plan = points[:, :2]
        self.assertEqual(cells_of(out), simplices_of(plan))
        sites = plan - plan[0]
        diagram = Voronoi(sites)
        low, high = sites.min(0) - 1, sites.max(0) + 1
        box = ",".join(repr(float(x)) for x in (*(low + plan[0]), *(high + plan[0])))
        areas = self.folder / "areas.csv"
        cells = self.folder / "cells.geojson"
        run("voronoi", path, "--columns", "x,y", "--box", box, "--measures", areas, "-o", cells)
        got = np.loadtxt(areas, skiprows=1)
        self.near(got.sum(), np.prod(high - low))
        frame = shapely.box(*low, *high)
        checked = 0
        for i, feature in enumerate(json.loads(cells.read_text())["features"]):
            cell = shape(feature["geometry"])
            self.assertTrue(cell.buffer(1e-6).contains(shapely.Point(plan[i])))
            region = diagram.regions[diagram.point_region[i]]
            if -1 in region:
                continue
            true = shapely.Polygon(diagram.vertices[region]).intersection(frame)
            self.near(got[i], true.area, 1e-6)
            self.near(cell.area, true.area, 1e-3)  # of coordinates far from the origin
            checked += 1
        self.assertGreater(checked, 300)

    def shapes_agree(self, path, points):
        plan = points[:, :2] - points[0, :2]
        triangles = Delaunay(plan).simplices
        circles, areas = radii(plan, triangles)
        ascending = np.sort(circles)
        radius = (ascending[300] + ascending[301]) / 2
        out = self.folder / "alpha.geojson"
        run("alpha", path, "--columns", "x,y", "--alpha", repr(float(radius)), "-o", out)
        features = json.loads(out.read_text())["features"]
        self.near(sum(shape(f["geometry"]).area for f in features), areas[circles <= radius].sum(), 1e-6)
        sides = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
        lengths = np.sort(np.linalg.norm(plan[sides[:, 0]] - plan[sides[:, 1]], axis=1))
        length = (lengths[-100] + lengths[-101]) / 2
        run("alpha", path, "--columns", "x,y", "--edge-length", repr(float(length)), "-o", out)
        ring = shape(json.loads(out.read_text())["features"][0]["geometry"])
        ratio = (length - lengths[0]) / (lengths[-1] - lengths[0])
        expected = shapely.concave_hull(shapely.MultiPoint(plan), ratio)
        self.near(ring.area, expected.area, 1e-6)

    def test_tiles_of_a_common_grid_are_one_file(self):
        scales = (0.01, 0.02, 0.001)
        for version, point_format in (("1.2", 1), ("1.4", 6), ("1.4", 10)):
            origins = np.array([[484000.0, 5400000.0, 100.0], [484000.25, 5399999.98, 99.999],
                                [485000.0, 5400400.0, 0.0], [0.0, 5400000.0, 12.5]])
            numbers = self.random.integers(-(10**5), 10**5, (400, 3)) + np.array([0, 0, 10**5])
            classes = self.random.integers(0, 4, 400).astype(np.uint8)
            whole = self.folder / "whole.las"
            write_scan(whole, numbers.astype(np.int32), version, point_format, scales, origins[0], classes)
            tiles = []
            for i, rows in enumerate(np.array_split(np.arange(400), 4)):
                moved = numbers[rows] - np.rint((origins[i] - origins[0]) / scales).astype(np.int64)
                tiles.append(self.folder / f"tile{i}.las")
                # The steps of an axis differ, too: 0.01 in the place of 0.02.
                fine = np.array([1, 2, 1]) if i == 1 else np.ones(3, dtype=int)
                write_scan(tiles[-1], (moved * fine).astype(np.int32), version, point_format,
                           np.round(np.array(scales) / fine, 6), origins[i], classes[rows])
            plan = ("--columns", "x,y")
            for words, name in (
                (("hull",), "a.json"), (("hull", "--stream", "on"), "a.json"), (("hull",), "a.ply"),
                (("hull", "--stream", "off"), "a.obj"), (("hull", *plan), "a.geojson"),
                (("hull", "--by", "classification"), "a.csv"), (("delaunay",), "a.json"),
                (("delaunay", *plan), "a.vtp"), (("voronoi",), "a.json"),
                (("voronoi", *plan), "a.wkt"), (("alpha", *plan), "a.geojson"),
                (("alpha", "--ratio", "0.1", *plan), "a.wkt"), (("cull", "--stream", "on"), "a.xyz"),
            ):  # fmt: skip
                with self.subTest(words=words, name=name, version=version):
                    out = self.folder / name
                    run(words[0], whole, *words[1:], "-o", out)
                    expected = out.read_bytes()
                    run(words[0], *tiles, *words[1:], "-o", out)
                    self.assertEqual(out.read_bytes(), expected)


if __name__ == "__main__":
    PROGRAM = sys.argv.pop(1)
    unittest.main()
