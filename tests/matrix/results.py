"""Results of Python taken apart: what two doors are compared by, and every way out of a result."""

from __future__ import annotations

import types
from typing import Any

import numpy as np

#: Members that tell how points came and what the run was like.
VOLATILE = {"statistics", "report", "certificate", "diagram", "triangulation", "cells_of"}
#: Members that hold the points as they were given: compared as doubles.
GIVEN = {"points", "halfspaces", "x", "values"}
_PLAIN = (bool, int, float, str, bytes, type(None), np.generic)
_DEPTH = 6


def digest(value: Any, name: str = "", depth: int = 0) -> Any:
    """Bits of everything public, as nested tuples that compare."""
    if isinstance(value, np.ndarray):
        if value.dtype == object:
            return tuple(digest(v, name, depth + 1) for v in value)
        kept = value.astype(np.float64) if name in GIVEN else value
        return (value.shape, "" if name in GIVEN else str(value.dtype), np.ascontiguousarray(kept).tobytes())
    if isinstance(value, float):
        return float(value).hex()
    if isinstance(value, _PLAIN):
        return value
    if isinstance(value, dict):
        return tuple((str(k), digest(v, str(k), depth + 1)) for k, v in value.items())
    if isinstance(value, (list, tuple)) and not hasattr(value, "_fields"):
        return tuple(digest(v, name, depth + 1) for v in value)
    if depth > _DEPTH:
        return type(value).__name__
    return (type(value).__name__, *members(value, depth))


def members(value: Any, depth: int) -> list[tuple[str, Any]]:
    found = []
    for name in dir(value):
        if name.startswith("_") or name in VOLATILE:
            continue
        try:
            held = getattr(value, name)
        except Exception as error:  # SciPy's classes raise where a member has no meaning
            found.append((name, type(error).__name__))
            continue
        if callable(held) or isinstance(held, types.ModuleType):
            continue
        found.append((name, digest(held, name, depth + 1)))
    if hasattr(value, "__len__") and not hasattr(value, "_fields"):
        found.append(("len", len(value)))
    if type(value).__name__ in ("HullBatch", "GroupHulls"):
        items = list(value.values()) if hasattr(value, "values") else list(value)
        found.append(("items", tuple(digest(v, "", depth + 1) for v in items)))
    return found


def first_difference(a: Any, b: Any, at: str = "") -> str:
    """Where two digests part."""
    if isinstance(a, tuple) and isinstance(b, tuple) and len(a) == len(b):
        for i, (x, y) in enumerate(zip(a, b)):
            if x != y:
                named = isinstance(x, tuple) and len(x) == 2 and isinstance(x[0], str)
                return first_difference(x, y, f"{at}.{x[0]}" if named else f"{at}[{i}]")
    return f"{at or 'result'}: {str(a)[:120]} is not {str(b)[:120]}"
