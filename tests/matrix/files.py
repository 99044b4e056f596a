"""Writers of the file formats that the program reads, in as few lines as each takes."""

from __future__ import annotations

import io
import json
import struct
from typing import Any

import numpy as np

#: PLY's and PCD's names of scalar types.
PLY_TYPES = {"f4": "float", "f8": "double"}


def npy(p: Any) -> bytes:
    out = io.BytesIO()
    np.save(out, p)
    return out.getvalue()


def npz(p: Any) -> bytes:
    out = io.BytesIO()
    np.savez(out, points=p)
    return out.getvalue()


def lines(p: Any, separator: str = " ", head: str = "") -> bytes:
    rows = [separator.join(repr(float(x)) for x in row) for row in p]
    return (head + "".join(f"{row}\n" for row in rows)).encode()


def csv_of_names(p: Any) -> bytes:
    """With a line of names; of x, y, z, w the program would take three."""
    names = "xyz" if p.shape[1] <= 3 else "abcdefghij"
    return lines(p, ",", ",".join(names[: p.shape[1]]) + "\n")


def json_rows(p: Any) -> bytes:
    return json.dumps({"name": "rows", "points": p.tolist()}).encode()


def decimal_commas(p: Any, separator: str) -> bytes:
    return lines(p, separator).replace(b".", b",")


def pts(p: Any) -> bytes:
    """Leica's: the number of points, then x, y, z and an intensity."""
    return lines(np.column_stack([p, np.full(len(p), -7.0)]), head=f"{len(p)}\n")


def ptx(p: Any) -> bytes:
    """Leica's: a scan of one column at the origin, in which some records have no return."""
    axes = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n"
    head = f"1\n{len(p) + 2}\n{axes}1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n"
    missed = b"0 0 0 0.5\n"
    rows = lines(np.column_stack([p, np.full(len(p), 0.25)]))
    return head.encode() + missed + rows + missed


def node(p: Any) -> bytes:
    """Triangle's and TetGen's: numbered from 1, with an attribute and a marker."""
    rows = [
        " ".join([str(i + 1), *(repr(float(x)) for x in row), "2.5", "0"]) for i, row in enumerate(p)
    ]
    return "\n".join([f"{len(p)} {p.shape[1]} 1 1", *rows, "# end", ""]).encode()


def asc(p: Any) -> bytes:
    """CloudCompare's: names in a comment, the number of points, a colour behind x, y, z."""
    colour = np.tile([255.0, 0.0, 7.0], (len(p), 1))
    return lines(np.column_stack([p, colour]), head=f"//X Y Z R G B\n{len(p)}\n")


def csv_among_others(p: Any) -> bytes:
    """An id before, a word and a number behind the coordinates."""
    names = ("x", "y", "z", "w")[: p.shape[1]]
    rows = [
        ",".join([str(i + 7), *(repr(float(x)) for x in row), f"tree {i % 3}", "1.5"])
        for i, row in enumerate(p)
    ]
    return "\n".join([",".join(["id", *names, "label", "height"]), *rows, ""]).encode()


def qhull(p: Any) -> bytes:
    return lines(p, " ", f"{p.shape[1]} points\n{len(p)}\n")


def cdd(p: Any) -> bytes:
    head = f"V-representation\nbegin\n {len(p)} {p.shape[1] + 1} real\n"
    return (
        head + "".join(f"1 {row}\n" for row in lines(p).decode().splitlines()) + "end\n"
    ).encode()


def _position(row: Any) -> list[float]:
    return [float(x) for x in row]


def geojson(p: Any) -> bytes:
    return json.dumps({"type": "MultiPoint", "coordinates": [_position(r) for r in p]}).encode()


def geojson_features(p: Any) -> bytes:
    """A feature for each point, among members that hold no points."""
    features = [
        {
            "type": "Feature",
            "properties": {"id": i, "coordinates": [9.0]},
            "geometry": {"type": "Point", "coordinates": _position(row)},
        }
        for i, row in enumerate(p)
    ]
    return json.dumps({"type": "FeatureCollection", "features": features}, indent=1).encode()


def _wkt_tag(name: str, p: Any) -> str:
    return f"{name} Z" if p.shape[1] == 3 else name


def wkt(p: Any) -> bytes:
    rows = ", ".join(f"({row})" for row in lines(p).decode().splitlines())
    return f"{_wkt_tag('MULTIPOINT', p)} {f'({rows})' if len(p) else 'EMPTY'}\n".encode()


def wkt_lines(p: Any) -> bytes:
    rows = lines(p).decode().splitlines()
    return "".join(f"{_wkt_tag('POINT', p)} ({row})\n" for row in rows).encode()


def ply(p: Any, kind: str = "binary_little_endian", dtype: str = "f8") -> bytes:
    axes = "".join(f"property {PLY_TYPES[dtype]} {a}\n" for a in "xyz"[: p.shape[1]])
    head = f"ply\nformat {kind} 1.0\nelement vertex {len(p)}\n{axes}end_header\n".encode()
    if kind == "ascii":
        return head + lines(p)
    return head + p.astype((">" if "big" in kind else "<") + dtype).tobytes()


def obj(p: Any) -> bytes:
    return b"# points\n" + b"".join(b"v " + row + b"\n" for row in lines(p).splitlines())


def off(p: Any) -> bytes:
    return lines(p, " ", f"OFF\n{len(p)} 0 0\n")


def stl(p: Any) -> bytes:
    corners = p.astype("<f4").reshape(-1, 9)
    body = b"".join(bytes(12) + corner.tobytes() + bytes(2) for corner in corners)
    return bytes(80) + struct.pack("<I", len(corners)) + body


def stl_ascii(p: Any) -> bytes:
    text = ["solid points"]
    for i in range(0, len(p), 3):
        corners = [f"vertex {row}" for row in lines(p[i : i + 3]).decode().splitlines()]
        text += ["facet normal 0 0 0", "outer loop", *corners, "endloop", "endfacet"]
    return "\n".join([*text, "endsolid points", ""]).encode()


def _literal_runs(data: bytes) -> bytes:
    """LZF that compresses nothing."""
    return b"".join(
        bytes([len(data[i : i + 32]) - 1]) + data[i : i + 32] for i in range(0, len(data), 32)
    )


def pcd(p: Any, kind: str = "binary", dtype: str = "f8") -> bytes:
    d = p.shape[1]
    size = dtype[1]
    head = (
        f"VERSION 0.7\nFIELDS {' '.join('xyz'[:d])}\nSIZE {' '.join(size * d)}\n"
        f"TYPE {' '.join('F' * d)}\nCOUNT {' '.join('1' * d)}\nWIDTH {len(p)}\nHEIGHT 1\n"
        f"VIEWPOINT 0 0 0 1 0 0 0\nPOINTS {len(p)}\nDATA {kind}\n"
    ).encode()
    values = p.astype("<" + dtype)
    if kind == "ascii":
        return head + lines(p)
    if kind == "binary":
        return head + values.tobytes()
    data = np.ascontiguousarray(values.T).tobytes()
    packed = _literal_runs(data)
    return head + struct.pack("<II", len(packed), len(data)) + packed


def las(numbers: Any, scale: Any, offset: Any) -> bytes:
    """LAS 1.2, point format 0."""
    n = len(numbers)
    records = np.zeros(
        n,
        np.dtype(
            [
                ("xyz", "<i4", 3),
                ("intensity", "<u2"),
                ("flags", "u1"),
                ("class", "u1"),
                ("angle", "i1"),
                ("user", "u1"),
                ("source", "<u2"),
            ]
        ),
    )
    records["xyz"] = numbers
    records["flags"] = 9  # first of one return
    records["class"] = np.arange(n) % 3
    world = numbers * np.asarray(scale) + np.asarray(offset) if n else np.zeros((1, 3))
    box = [v for high, low in zip(world.max(axis=0), world.min(axis=0)) for v in (high, low)]
    head = struct.pack(
        "<4sHH16sBB32s32sHHHIIBHI5I12d",
        b"LASF",
        0,
        0,
        bytes(16),
        1,
        2,
        b"matrix",
        b"matrix",
        1,
        2024,
        227,
        227,
        0,
        0,
        20,
        n,
        n,
        0,
        0,
        0,
        0,
        *scale,
        *offset,
        *box,
    )
    return head + records.tobytes()
