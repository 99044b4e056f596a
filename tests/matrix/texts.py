"""Readers of what the program writes: each raises where a file is not what its name says.

A reader returns the coordinates that the file holds, (m, d), or None where it holds none; the
runner compares them with the points that went in.
"""

from __future__ import annotations

import io
import json
import re
import struct
import xml.etree.ElementTree as xml
import zipfile
from typing import Any, Callable, Optional

import numpy as np


class Unreadable(Exception):
    """A file that is not what its name says."""


def _need(condition: Any, what: str) -> None:
    if not condition:
        raise Unreadable(what)


def strict_json(text: bytes) -> Any:
    """JSON by the letter: NaN and Infinity are none of it, and no key comes twice."""

    def refuse(word: str) -> Any:
        raise Unreadable(f"{word} is no JSON")

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        names = [name for name, _ in pairs]
        _need(len(set(names)) == len(names), f"a key twice: {names}")
        return dict(pairs)

    return json.loads(text, parse_constant=refuse, object_pairs_hook=once)


def _indices(faces: list[list[int]], count: int) -> None:
    for face in faces:
        _need(all(0 <= i < count for i in face), f"face {face} of {count} vertices")
        _need(len(set(face)) == len(face), f"a corner twice in {face}")


def ply(data: bytes) -> Any:
    head, _, body = data.partition(b"end_header\n")
    words = [line.split() for line in head.decode().splitlines()]
    _need(words[0] == ["ply"] and words[1][:2] == ["format", "binary_little_endian"], "no PLY")
    counts = {w[1]: int(w[2]) for w in words if w[0] == "element"}
    axes = [w[1:] for w in words if w[0] == "property" and w[1] != "list"]
    kinds = {
        "double": "<f8",
        "float": "<f4",
        "int": "<i4",
        "uchar": "u1",
        "short": "<i2",
        "char": "i1",
        "ushort": "<u2",
        "uint": "<u4",
    }
    record = np.dtype([(name, kinds[kind]) for kind, name in axes])
    rows = np.frombuffer(body, record, counts["vertex"])
    corners = np.array([[float(row[n]) for n in record.names] for row in rows]).reshape(
        -1, len(axes)
    )
    at, faces = record.itemsize * len(rows), []
    lists = [w for w in words if w[:2] == ["property", "list"]]
    for _ in range(counts.get("face", 0)):
        size = np.dtype(kinds[lists[0][2]])
        k = int(np.frombuffer(body, size, 1, at)[0])
        faces.append(np.frombuffer(body, kinds[lists[0][3]], k, at + size.itemsize).tolist())
        at += size.itemsize + k * np.dtype(kinds[lists[0][3]]).itemsize
    _need(at == len(body), f"{len(body) - at} bytes behind the faces")
    _indices(faces, len(corners))
    return corners


def obj(data: bytes) -> Any:
    corners, faces = [], []
    for line in data.decode().splitlines():
        word, *rest = line.split() or ["#"]
        _need(word in ("#", "v", "f", "l", "p") or word.startswith("#"), f"line {line!r}")
        if word == "v":
            corners.append([float(x) for x in rest])
        elif word == "f":
            faces.append([int(x) - 1 for x in rest])
    _indices(faces, len(corners))
    return np.array(corners).reshape(-1, 3)


def off(data: bytes) -> Any:
    words = iter(re.sub(rb"#.*", b"", data).split())
    _need(next(words) == b"OFF", "no OFF")
    n, m, _ = (int(next(words)) for _ in range(3))
    corners = np.array([float(next(words)) for _ in range(3 * n)]).reshape(-1, 3)
    faces = [[int(next(words)) for _ in range(int(next(words)))] for _ in range(m)]
    _need(next(words, None) is None, "text behind the faces")
    _indices(faces, n)
    return corners


def stl(data: bytes) -> Any:
    (count,) = struct.unpack_from("<I", data, 80)
    _need(len(data) == 84 + 50 * count and count, f"{len(data)} bytes for {count} triangles")
    rows = np.frombuffer(
        data, np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]), count, 84
    )
    return rows["v"].reshape(-1, 3).astype(float)


def glb(data: bytes) -> Any:
    magic, version, length = struct.unpack_from("<4sII", data)
    _need((magic, version, length) == (b"glTF", 2, len(data)), "no glTF 2")
    size, kind = struct.unpack_from("<I4s", data, 12)
    _need(kind == b"JSON", "no JSON chunk")
    scene = strict_json(data[20 : 20 + size])
    binary = data[28 + size :]
    part = scene["meshes"][0]["primitives"][0]["attributes"]["POSITION"]
    accessor = scene["accessors"][part]
    start = scene["bufferViews"][accessor["bufferView"]].get("byteOffset", 0)
    corners = (
        np.frombuffer(binary, "<f4", 3 * accessor["count"], start).reshape(-1, 3).astype(float)
    )
    return corners + np.array(scene["nodes"][0].get("translation", [0, 0, 0]))


def vtp(data: bytes) -> Any:
    root = xml.fromstring(data)
    piece = root.find(".//Piece")
    _need(root.get("type") == "PolyData" and piece is not None, "no PolyData")
    array = piece.find("Points/DataArray")
    corners = np.array((array.text or "").split(), float).reshape(-1, 3)
    _need(len(corners) == int(piece.get("NumberOfPoints", -1)), "another number of points")
    for kind in ("Verts", "Lines", "Polys"):
        found = piece.find(kind)
        if found is None:
            continue
        arrays = {a.get("Name"): np.array((a.text or "").split(), int) for a in found}
        joined, ends = arrays["connectivity"], arrays["offsets"]
        _need(not len(joined) or (joined.min() >= 0 and joined.max() < len(corners)), kind)
        _need(not len(ends) or ends[-1] == len(joined), f"offsets of {kind}")
    return corners


def vtk(data: bytes) -> Any:
    text = data.decode()
    _need(text.startswith("# vtk DataFile") and "UNSTRUCTURED_GRID" in text, "no VTK")
    found = re.search(r"POINTS (\d+) double\s+(.*?)CELLS", text, re.S)
    _need(found, "no points")
    return np.array(found[2].split(), float).reshape(int(found[1]), 3)


def _rings(geometry: Any) -> list[Any]:
    if geometry is None:
        return []
    kind, held = geometry["type"], geometry.get("coordinates")
    if kind == "GeometryCollection":
        return [r for g in geometry["geometries"] for r in _rings(g)]
    if kind == "Point":
        return [[held]]
    if kind in ("LineString", "MultiPoint"):
        return [held]
    polygons = held if kind == "MultiPolygon" else [held] if kind == "Polygon" else None
    if kind == "MultiLineString":
        return list(held)
    _need(polygons is not None, f"geometry of type {kind}")
    for ring in (r for p in polygons for r in p):
        _need(len(ring) >= 4 and ring[0] == ring[-1], f"ring {ring[:2]}... is not closed")
    return [r for p in polygons for r in p]


def geojson(data: bytes) -> Any:
    parsed = strict_json(data)
    _need(parsed["type"] in ("Feature", "FeatureCollection"), "neither feature nor collection")
    features = parsed["features"] if parsed["type"] == "FeatureCollection" else [parsed]
    corners = [c for f in features for ring in _rings(f["geometry"]) for c in ring]
    # Polygons are of the plane; points of space have heights.
    return np.array(corners, float).reshape(-1, len(corners[0]) if corners else 2)


def wkt(data: bytes) -> Any:
    text = data.decode()
    for line in text.splitlines():
        _need(re.match(r"^(MULTI)?(POLYGON|LINESTRING|POINT)|^GEOMETRYCOLLECTION", line), line[:60])
        _need(line.count("(") == line.count(")"), "brackets")
    return np.array(
        [
            [float(x) for x in pair]
            for pair in re.findall(r"(-?[\d.][\d.e+-]*) (-?[\d.][\d.e+-]*)", text)
        ]
    ).reshape(-1, 2)


def npy(data: bytes) -> Any:
    return np.load(io.BytesIO(data), allow_pickle=False)


def ids(data: bytes) -> Any:
    array = npy(data)
    _need(array.dtype == np.int64 and array.ndim == 1, f"{array.dtype} {array.shape}")
    _need((np.diff(array) > 0).all(), "not ascending")
    return array


def ids_csv(data: bytes) -> Any:
    head, *rows = data.decode().splitlines()
    _need(head == "id" and all(row.isdigit() for row in rows), f"head {head!r}")
    return np.array(rows, np.int64)


def ids_txt(data: bytes) -> Any:
    rows = data.decode().splitlines()
    _need(all(row.isdigit() for row in rows), "not numbers alone")
    return np.array(rows, np.int64)


def points_npy(data: bytes) -> Any:
    return npy(data).astype(float)


def points_csv(data: bytes) -> Any:
    head, *rows = data.decode().splitlines()
    names = head.split(",")
    found = [[float(x) for x in row.split(",")] for row in rows]
    _need(names[0] in ("x", "x0") and all(len(r) == len(names) for r in found), head)
    return np.array(found).reshape(-1, len(names))


def points_txt(data: bytes) -> Any:
    rows = [[float(x) for x in row.split()] for row in data.decode().splitlines()]
    return np.array(rows) if rows else None


def counted_txt(data: bytes) -> Any:
    """With Qhull's header: dimension, count, rows."""
    head, count, *rows = data.decode().splitlines()
    dimension = int(head.split()[0])  # words may follow
    found = np.array([[float(x) for x in row.split()] for row in rows]).reshape(-1, dimension)
    _need(len(found) == int(count), "another count")
    return found


def archive(data: bytes) -> Any:
    with zipfile.ZipFile(io.BytesIO(data)) as packed:
        _need(packed.testzip() is None, "a check sum differs")
        names = {name.removesuffix(".npy"): npy(packed.read(name)) for name in packed.namelist()}
    _need({"ids", "points"} <= set(names), f"arrays {sorted(names)}")
    return names["points"].astype(float)


def result_json(data: bytes) -> Any:
    parsed = strict_json(data)
    if "vertex_coordinates" in parsed:
        return np.array(parsed["vertex_coordinates"], float).reshape(
            -1, parsed["points"]["dimension"]
        )
    return None


def page(data: bytes) -> None:
    _need(data.lstrip().lower().startswith(b"<!doctype html") and b"</html>" in data, "no page")


def table_csv(data: bytes) -> None:
    head, *rows = data.decode().splitlines()
    _need("," in head and all("," in row for row in rows), head)


def text(data: bytes) -> None:
    data.decode("ascii")
    _need(b"nan" not in data.lower(), "NaN in the text")


def measures(data: bytes) -> None:
    _need((npy(data) >= 0).all(), "a negative measure")


def measures_csv(data: bytes) -> None:
    numbers = data.decode().splitlines()
    _need(all(float(x) >= 0 for x in numbers if not re.match("[a-z]", x)), "a negative measure")


#: A reader returns coordinates or None.
Reader = Callable[[bytes], Optional[Any]]
