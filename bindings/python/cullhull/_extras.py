"""Packages that some functions need beside NumPy, and the extras that install them."""

from __future__ import annotations

from typing import Any


def needed(module: str, purpose: str, extra: str) -> Any:
    """Imports ``module``; where it is missing, an ImportError names the extra that installs it.

    ``purpose`` is the subject of the message: ``to_shapely()``, ``reading .laz files``.
    """
    import importlib

    try:
        return importlib.import_module(module)
    except ModuleNotFoundError as error:
        package = module.partition(".")[0]
        missing = (error.name or package).partition(".")[0]
        if missing != package and missing != "cullhull":
            package = f"{package} with {missing}"
        raise ImportError(
            f"{purpose} needs {package}, which is not installed: pip install 'cullhull[{extra}]'"
        ) from None
