"""Whether what came by two doors is the same."""

from __future__ import annotations

import re
from typing import Any, Optional

import numpy as np

import rounding
import texts
from commands import Output

#: Members of a report that tell how points came and what the run was like, not what was found.
VOLATILE = re.compile(
    r"seconds|bytes|version|^format$|in_place|stride|scalar|^backend$|threads|^cull$|^engine$|"
    r"^columns$|^plan$|^reason$|^placement$|survivors|share|exact_decisions|^method$|^output$|per_second"
)
_BINARY = (".npy", ".npz", ".ply", ".stl", ".glb")
_NUMBER = re.compile(rb"(?<![\w.])-?(?:\d[\d.]*|inf)(?:[eE][+-]?\d+)?")


def stripped(value: Any) -> Any:
    """A report without what changes from run to run."""
    if isinstance(value, dict):
        return {k: stripped(v) for k, v in value.items() if not VOLATILE.search(k)}
    return [stripped(v) for v in value] if isinstance(value, list) else value


def comparable(output: Output, data: bytes) -> bytes:
    """What has to be equal, byte for byte."""
    if output.alike == "report":
        return repr(stripped(texts.strict_json(data))).encode()
    if output.alike == "scalar":
        return re.sub(rb'"scalar": "\w+"', b"", data)
    if output.alike in ("values", "survivors"):
        found = output.read(data)
        if found is None:
            return b""
        return repr(found.shape).encode() + np.ascontiguousarray(found, float).tobytes()
    if output.alike == "page":
        data = re.sub(rb"<title>.*?</title>", b"", data)
        data = re.sub(rb'"(scalar|threads|backend)": ?"?\w+"?', b"", data)
        data = re.sub(rb',\s*"columns": ?\[[^\]]*\]', b"", data)
        data = re.sub(rb'"(cull|hull)": ?\{[^}]*\}', b"", data)
        return re.sub(rb'"\w*(seconds|seconds_all|bytes)": ?\[?[\d.e+-]*\]?', b"", data)
    return data


def difference(
    output: Output, got: bytes, want: bytes, exact: bool, points: Any
) -> Optional[str]:
    """`exact`: the bits are due; else what rounded `points` can make of them."""
    a, b = comparable(output, got), comparable(output, want)
    if a == b:
        return None
    if not exact and _close(output, got, want, points):
        return None
    at = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
    if output.ending in _BINARY:
        return f"differs from byte {at} on ({len(a)} bytes, {len(b)} by the reference)"
    cut = slice(max(at - 20, 0), at + 50)
    return f"differs at byte {at}: {a[cut]!r}, by the reference {b[cut]!r}"


def _close(output: Output, got: bytes, want: bytes, points: Any) -> bool:
    """The same words and whole numbers, and decimals within a rounding of each coordinate."""
    if output.ending == ".json":
        a, b = texts.strict_json(got), texts.strict_json(want)
        if b.get("kind") == "voronoi":
            return rounding.same_diagram(a, b, points)
    if output.alike in ("values", "survivors") or output.ending in _BINARY:
        a, b = output.read(got), output.read(want)
        if a is None or b is None:
            return a is b
        return a.shape == b.shape and bool(np.allclose(a, b, rtol=1e-9, atol=1e-6))
    a, b = (b" ".join(comparable(output, data).split()) for data in (got, want))
    if _NUMBER.sub(b"#", a) != _NUMBER.sub(b"#", b):
        return False
    return all(
        x == y or abs(float(x) - float(y)) <= 1e-6 + 1e-9 * abs(float(y))
        for x, y in zip(_NUMBER.findall(a), _NUMBER.findall(b))
    )
