"""Results as files for maps: their coordinate reference systems, and formats that pyogrio writes."""

from __future__ import annotations

import json
import os
import re
import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import _core
from .._errors import FileError, InvalidArgument
from . import _vectors

#: How our GeoJSON begins where it names a system.
_HEAD = re.compile(r'\{"type": "Feature(?:Collection)?", "crs": (\{.*?\}\}), ')
_MAPS = ("geojson", *(ending[1:] for ending in _vectors.DRIVERS))


def geojson_crs(path: str | os.PathLike[str]) -> str | None:
    """The system that a GeoJSON file of ours names: EPSG:25832."""
    with open(path, encoding="utf-8") as file:
        found = _HEAD.match(file.read(1000))
    if found is None:
        return None
    urn: Any = json.loads(found[1])["properties"]["name"]
    authority, _, code = str(urn).split(":")[-3:]
    return f"{authority}:{code}"


def crs_code(crs: Any) -> str:
    """AUTHORITY:CODE of a text or of an object of pyproj; empty for None."""
    if crs is None:
        return ""
    if hasattr(crs, "to_authority"):
        found = crs.to_authority()
        code = ":".join(found) if found else ""
    elif isinstance(crs, int):
        code = f"EPSG:{crs}"
    else:
        code = _core.crs_code(str(crs)) or _core.crs_of_wkt(str(crs))
    if not code:
        raise InvalidArgument("crs: an authority and a code are expected, such as 'EPSG:25832'")
    return code


def save_map(
    path: str | os.PathLike[str], format: str, crs: Any, write: Callable[[str, str, str], Any]
) -> None:
    """Calls write(path, format, crs); for what pyogrio writes, with a GeoJSON file that becomes it."""
    path = os.fspath(path)
    kind = format or os.path.splitext(path)[1][1:].lower()
    code = crs_code(crs)
    if code and kind not in _MAPS:
        raise InvalidArgument(f"crs: .{kind} holds none; .{' .'.join(_MAPS)} do")
    if f".{kind}" not in _vectors.DRIVERS:
        write(path, format, code)
        return
    with tempfile.TemporaryDirectory(prefix="cullhull-") as folder:
        made = os.path.join(folder, "made.geojson")
        write(made, "", code)
        try:
            move_vector(made, path, code or None, kind)
        except OSError as error:
            raise FileError(f"{path}: {error.strerror}") from None


def move_vector(made: str, path: str, crs: str | None, kind: str = "") -> None:
    """A GeoJSON file of ours as a vector file at `path`, whole or not at all."""
    ending = f".{kind}" if kind else os.path.splitext(path)[1].lower()
    place = Path(tempfile.mkdtemp(dir=Path(made).parent))
    _vectors.write_result(str(place / (Path(path).stem + ending)), made, crs, path)
    if ending == ".shp" and os.path.exists(path):  # nor may a part of the old one stay
        for part in (".shx", ".dbf", ".prj", ".cpg", ".qix", ".sbn", ".sbx"):
            Path(path).with_suffix(part).unlink(missing_ok=True)
    for file in sorted(place.iterdir()):  # a Shapefile is several files
        target = Path(path) if file.suffix == ending else Path(path).with_suffix(file.suffix)
        shutil.move(str(file), str(target))
