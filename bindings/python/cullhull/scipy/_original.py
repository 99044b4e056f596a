"""SciPy's own classes and functions, also where a program has put ours into their place."""

from __future__ import annotations

import importlib
import re
from typing import Any

#: The modules that define them, newest first, by the public one.
_HOMES = {
    "scipy.spatial": ("scipy.spatial._qhull", "scipy.spatial.qhull"),
    "scipy.interpolate": ("scipy.interpolate._ndgriddata", "scipy.interpolate.ndgriddata"),
}


def scipy_version() -> tuple[int, int]:
    """The version of the installed SciPy, found without importing it; (0, 0) if there is none."""
    import importlib.metadata

    try:
        numbers = re.findall(r"\d+", importlib.metadata.version("scipy"))
    except importlib.metadata.PackageNotFoundError:
        return 0, 0
    return int(numbers[0]), int(numbers[1])


def of_scipy(public: str, name: str) -> Any:
    """What SciPy itself calls so; None without SciPy, or where only ours can be found.

    A program that sets ``scipy.spatial.Delaunay = cullhull.Delaunay`` replaces a name of the public
    module: the one that defines the class still has SciPy's.
    """
    try:
        importlib.import_module(public)
    except ImportError:
        return None
    for module in (*_HOMES[public], public):
        try:
            found = getattr(importlib.import_module(module), name, None)
        except ImportError:
            continue
        if found is not None and not found.__module__.startswith("cullhull"):
            return found
    return None
