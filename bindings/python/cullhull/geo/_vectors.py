"""Vector files (GeoPackage, Shapefile, FlatGeobuf, GML, KML), with pyogrio: their vertices, fields
and coordinate reference systems; and such files of our results."""

from __future__ import annotations

import csv
import importlib
import json
import os
import re
import struct
import warnings
from collections.abc import Iterable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import BadFile, Error
from ._columns import faults_of_a_package

Rows = npt.NDArray[np.float64]

ENDINGS = (".gpkg", ".shp", ".fgb", ".gml", ".kml")
#: Endings of files that are written, with the names of their drivers.
DRIVERS = {".gpkg": "GPKG", ".shp": "ESRI Shapefile", ".fgb": "FlatGeobuf"}

_POINT, _LINE, _POLYGON, _TRIANGLE = 1, 2, 3, 17
_COLLECTIONS = (4, 5, 6, 7, 15, 16)  # multi-, collections, polyhedral surfaces, TINs
#: GeoJSON's names of the types of WKB; those of triangles and surfaces that hold the same.
_NAMES = {1: "Point", 2: "LineString", 3: "Polygon", 4: "MultiPoint", 5: "MultiLineString",
          6: "MultiPolygon", 7: "GeometryCollection", 15: "MultiPolygon", 16: "MultiPolygon",
          17: "Polygon"}  # fmt: skip
#: Geometries read at a time: some tenths of a second where they are polygons.
_MANY = 1 << 14
#: GDAL's own stream of FlatGeobuf loses features beside those without a geometry (GDAL 3.12).
_PLAIN_STREAM = "OGR_FLATGEOBUF_STREAM_BASE_IMPL"
#: How points of 2 and 3 coordinates begin, in the byte order of most files.
_PLAIN_POINTS = {struct.pack("<BI", 1, kind): 2 + (kind != 1) for kind in (1, 1001, 0x80000001)}
_LAYER = re.compile(r"(.*\.gpkg):([^/]+)$", re.IGNORECASE)


def split_layer(word: str) -> tuple[str, str | None]:
    """FILE.gpkg:LAYER as its two parts."""
    found = _LAYER.match(word)
    return (found[1], found[2]) if found else (word, None)


def blocks(word: str, size: int | None = None) -> Iterator[Rows]:
    """The positions of all geometries, (n, 2) or (n, 3) a block, of at most `size` rows if given; a
    ring's last, which is its first again, is not taken.

    A block is of a few thousand geometries, so that memory stays small and Ctrl-C is heard. At
    least one block comes, perhaps of no rows. Raises `BadFile`, or `ImportError` without a package.
    """
    path = split_layer(word)[0]
    before: Rows | None = None
    empty = True
    for parts in _parts(path, word):
        if not parts:
            continue
        before = rows = _together(parts, path, before)
        empty = empty and not len(rows)
        for start in range(0, len(rows), size or len(rows) or 1):
            yield rows[start : start + size] if size else rows
    if empty:
        yield np.empty((0, 2)) if before is None else before


def _together(parts: list[Rows], path: str, before: Rows | None = None) -> Rows:
    """One array, of as many coordinates as the block before has."""
    widths = {part.shape[1] for part in (*parts, *([] if before is None else [before]))}
    if len(widths) > 1:
        raise BadFile(f"{path}: some geometries have heights and others have none")
    return np.concatenate(parts) if parts else np.empty((0, 2))


@contextmanager
def _opened(word: str, fields: list[str]) -> Iterator[tuple[dict[str, Any], Any]]:
    """What is known of a layer, and a pyarrow reader of its geometries and these fields; faults of
    the packages become `BadFile`."""
    path, layer = split_layer(word)
    pyogrio = _pyogrio(path)
    with faults_of_a_package(path), ExitStack() as stack:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of measures, which are not taken
            name = _chosen(pyogrio, path, layer)
            opened = pyogrio.open_arrow(
                path, layer=name, columns=fields, batch_size=_MANY, use_pyarrow=True
            )
            meta, stream = stack.enter_context(opened)
        before = pyogrio.get_gdal_config_option(_PLAIN_STREAM)
        stack.callback(pyogrio.set_gdal_config_options, {_PLAIN_STREAM: before})
        pyogrio.set_gdal_config_options({_PLAIN_STREAM: True})
        yield meta, stream


def _parts(path: str, word: str) -> Iterator[list[Rows]]:
    """The vertices of some thousand geometries at a time."""
    with _opened(word, []) as (_, stream):
        for offsets, data in _binary_batches(stream):
            parts: list[Rows] = []
            try:
                add_all(parts, offsets, data)
            except BadFile as error:
                raise BadFile(f"{path}: {error}") from None
            yield parts


def _binary_batches(
    stream: Any,
) -> Iterator[tuple[npt.NDArray[np.int64], npt.NDArray[np.uint8]]]:
    """The first column of bytes in each batch of a pyarrow reader: where each value begins and
    ends, and the bytes of all values (none for a missing one). Nothing without such a column."""
    wide = {"binary": False, "large_binary": True}
    kinds = [(i, wide[str(field.type)]) for i, field in enumerate(stream.schema)
             if str(field.type) in wide]
    if not kinds:
        return
    place, large = kinds[0]
    for batch in stream:
        if len(batch):
            yield binary_values(batch.column(place), large)


def binary_values(
    column: Any, large: bool
) -> tuple[npt.NDArray[np.int64], npt.NDArray[np.uint8]]:
    """Where each value of a pyarrow column begins and ends, and the bytes of all values."""
    _, ends, data = column.buffers()
    offsets = np.frombuffer(ends, dtype="<i8" if large else "<i4")
    offsets = offsets[column.offset : column.offset + len(column) + 1].astype(np.int64)
    if (np.diff(offsets) < 0).any():
        raise OSError("the values of the Arrow stream overlap")
    taken = np.frombuffer(data or b"", dtype=np.uint8)[offsets[0] : offsets[-1]]
    return offsets - offsets[0], taken


def _pyogrio(path: str) -> Any:
    for package in ("pyogrio", "pyarrow"):
        try:
            importlib.import_module(package)
        except ImportError:
            raise ImportError(
                f"{path}: reading {os.path.splitext(path)[1]} files needs {package}, which is not "
                "installed: pip install 'cullhull[vector]'"
            ) from None
    return importlib.import_module("pyogrio")


def _chosen(pyogrio: Any, path: str, layer: str | None) -> str:
    """The layer to read: the one that is named, or the only one with geometries."""
    found = {str(name): kind for name, kind in pyogrio.list_layers(path)}
    spatial = [name for name, kind in found.items() if kind is not None]
    if layer is not None and layer not in found:
        raise BadFile(f"{path}: has no layer {layer!r}; there are {', '.join(found) or 'none'}")
    if not spatial or (layer is not None and layer not in spatial):
        which = "no layer has" if layer is None else f"layer {layer!r} has no"
        raise BadFile(f"{path}: {which} geometries")
    if layer is None and len(spatial) > 1:
        named = ", ".join(f"{path}:{name}" for name in spatial)
        raise BadFile(f"{path}: has several layers: {named}")
    return layer or spatial[0]


def add_all(
    parts: list[Rows], offsets: npt.NDArray[np.int64], data: npt.NDArray[np.uint8]
) -> None:
    """Adds the vertices of many geometries in WKB; of points at once."""
    lengths = np.diff(offsets)
    points = plain_points(lengths, data)
    if points is not None:
        parts.append(points[~np.isnan(points).all(axis=1)])  # no POINT EMPTY
        return
    whole = data.tobytes()
    for at, length in zip(offsets[:-1].tolist(), lengths.tolist()):
        if length:  # a feature may have no geometry
            add(parts, whole, at)


def plain_points(
    lengths: npt.NDArray[np.int64], data: npt.NDArray[np.uint8]
) -> Rows | None:
    """The positions of many points in WKB of one kind; None for anything else."""
    size = int(lengths[0]) if len(lengths) else 0
    if size < 21 or not (lengths == size).all():
        return None
    rows = data.reshape(-1, size)
    head = rows[0, :5].tobytes()
    if head not in _PLAIN_POINTS or not (rows[:, :5] == rows[0, :5]).all():
        return None
    width = _PLAIN_POINTS[head]
    if size < 5 + 8 * width:
        return None
    return np.ascontiguousarray(rows[:, 5 : 5 + 8 * width]).view("<f8")


def wkb_head(data: bytes, at: int) -> tuple[int, bool, int, int]:
    """The head of the WKB geometry at byte `at`, of ISO or of PostGIS: its type, whether it has
    heights, the numbers of a position (with a measure), and where its contents begin."""
    (kind,) = struct.unpack_from(("<" if data[at] == 1 else ">") + "I", data, at + 1)
    at += 9 if kind & 0x20000000 else 5  # an SRID follows
    base = kind & 0xFFFF
    has_z = bool(kind & 0x80000000) or base // 1000 in (1, 3)
    width = 2 + has_z + (bool(kind & 0x40000000) or base // 1000 in (2, 3))
    return base % 1000, has_z, width, at


#: A geometry in WKB: its type, its positions (a line, or rings), and the parts of a collection.
Geometry = tuple[int, list[Rows], list[Any]]


def parsed(data: bytes, at: int) -> tuple[Geometry, int]:
    """The WKB geometry at byte `at`, and where it ends."""
    order = "<" if data[at] == 1 else ">"
    kind, has_z, width, at = wkb_head(data, at)
    if kind not in _NAMES:
        raise BadFile(f"curves (WKB type {kind}) have no vertices to take")
    lines: list[Rows] = []
    parts: list[Geometry] = []

    def number() -> int:
        nonlocal at
        (found,) = struct.unpack_from(order + "I", data, at)
        at += 4
        return int(found)

    for _ in range(1 if kind in (_POINT, _LINE) else number()):
        if kind in _COLLECTIONS:
            part, at = parsed(data, at)
            parts.append(part)
            continue
        count = 1 if kind == _POINT else number()
        rows = np.frombuffer(data, order + "f8", count * width, at).reshape(count, width)
        at += rows.nbytes
        lines.append(rows[:, : 2 + has_z].astype(np.float64))
    return (kind, lines, parts), at


def add(parts: list[Rows], data: bytes, at: int) -> int:
    """Adds the vertices of the WKB geometry at byte `at`; returns where it ends."""
    geometry, end = parsed(data, at)
    _add(parts, geometry)
    return end


def _add(parts: list[Rows], geometry: Geometry) -> None:
    kind, lines, inner = geometry
    for part in inner:
        _add(parts, part)
    for rows in lines:
        if kind == _POINT and np.isnan(rows).all():  # POINT EMPTY
            continue
        closed = kind in (_POLYGON, _TRIANGLE) and len(rows) > 1 and (rows[0] == rows[-1]).all()
        parts.append(rows[:-1] if closed else rows)


# ------------------------------------------------------------------------ fields, systems, results


def describe(word: str, *, all_layers: bool = False) -> dict[str, Any]:
    """`format`, `crs` (as the file has it: EPSG:N, or a WKT; or None) and `fields` of the layer that
    is read; with `all_layers` also `layers`, whose features may have to be counted."""
    path, layer = split_layer(word)
    pyogrio = _pyogrio(path)
    with faults_of_a_package(path):
        info = pyogrio.read_info(path, layer=_chosen(pyogrio, path, layer))
        layers = []
        for name, kind in pyogrio.list_layers(path) if all_layers else ():
            about = pyogrio.read_info(path, layer=name, force_feature_count=True)
            layers.append(
                {"name": str(name), "features": int(about["features"]), "geometry": kind or "none"}
            )
    fields = [
        {"name": str(name), "type": _TYPES.get(str(kind).split("[")[0], str(kind))}
        for name, kind in zip(info["fields"], info["dtypes"])
    ]
    found = {"format": info["driver"], "crs": info["crs"], "fields": fields}
    return {**found, "layers": layers} if all_layers else found


#: pyogrio's names of types that a reader would not know.
_TYPES = {"object": "text", "datetime64": "time"}


def write_table(target: Path, word: str, fields: list[str]) -> None:
    """The vertices as a .csv of x, y (z) and these fields of their features."""
    path = split_layer(word)[0]
    before = 0
    with open(target, "w", newline="", encoding="utf-8") as file, _opened(word, fields) as (
        meta,
        stream,
    ):
        lines = csv.writer(file, lineterminator="\n")
        where = meta["geometry_name"] or "wkb_geometry"
        for batch in stream:
            values = [batch.column(batch.schema.get_field_index(f)).to_pylist() for f in fields]
            column = batch.column(batch.schema.get_field_index(where))
            for i, geometry in enumerate(column.to_pylist()):
                if geometry is None:
                    continue
                parts: list[Rows] = []
                add_all(
                    parts, np.array([0, len(geometry)]), np.frombuffer(geometry, dtype=np.uint8)
                )
                beside = [spelled(v[i]) for v in values]
                for part in parts:
                    if before not in (0, part.shape[1]):
                        raise BadFile(f"{path}: some geometries have heights and others have none")
                    if not before:
                        lines.writerow([*"xyz"[: part.shape[1]], *fields])
                    before = part.shape[1]
                    lines.writerows([*map(repr, row), *beside] for row in part.tolist())
        if not before:
            lines.writerow(["x", "y", *fields])


def spelled(value: Any) -> str:
    """A value of a field as one of a .csv: none as nothing, line breaks as blanks."""
    if value is None or value != value:
        return ""
    if isinstance(value, float):
        return repr(int(value)) if value.is_integer() and abs(value) < 2**53 else repr(value)
    return " ".join(str(value).splitlines())


def write_shapes(target: Path, word: str) -> None:
    """The geometries alone as GeoJSON."""
    with _opened(word, []) as (_, stream):
        write_features(target, _shapes(stream))


def _shapes(stream: Any) -> Iterator[dict[str, Any] | None]:
    for offsets, data in _binary_batches(stream):
        whole = data.tobytes()
        for at, end in zip(offsets[:-1].tolist(), offsets[1:].tolist()):
            yield _shape(parsed(whole, at)[0]) if end > at else None


def shape(geometry: bytes) -> dict[str, Any]:
    """A geometry in WKB as GeoJSON."""
    return _shape(parsed(geometry, 0)[0])


def _shape(geometry: Geometry) -> dict[str, Any]:
    kind, lines, inner = geometry
    made: dict[str, Any] = {"type": _NAMES[kind]}
    rows, parts = [part.tolist() for part in lines], list(map(_shape, inner))
    if kind == 7:
        made["geometries"] = parts
    elif kind in _COLLECTIONS:
        made["coordinates"] = [part["coordinates"] for part in parts]
    elif kind == _POINT:
        made["coordinates"] = [] if np.isnan(lines[0]).all() else rows[0][0]
    else:
        made["coordinates"] = rows[0] if kind == _LINE else rows
    return made


def write_features(target: Path, shapes: Iterable[dict[str, Any] | None]) -> None:
    """A GeoJSON file of geometries."""
    with open(target, "w", encoding="utf-8") as file:
        file.write('{"type": "FeatureCollection", "features": [')
        for i, made in enumerate(shapes):
            feature = {"type": "Feature", "properties": {}, "geometry": made}
            file.write(("\n" if i == 0 else ",\n") + json.dumps(feature))
        file.write("]}\n")


def write_result(target: str, geojson: str, crs: str | None, name: str) -> None:
    """A GeoJSON file of ours as .gpkg, .shp or .fgb, in this coordinate reference system. `name`: of
    the file that it becomes, for messages."""
    pyogrio = _pyogrio(name)
    ending = os.path.splitext(target)[1].lower()
    try:
        meta, table = pyogrio.read_arrow(geojson)
        where = meta["geometry_name"] or "wkb_geometry"
        kinds, columns = _layer_of(table, where)
        missing = columns.column(columns.schema.get_field_index(where)).null_count > 0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of names that a Shapefile shortens, of no system
            pyogrio.write_arrow(
                columns,
                target,
                driver=DRIVERS[ending],
                geometry_name=where,
                geometry_type=kinds,
                crs=crs,
                layer=Path(target).stem if ending == ".gpkg" else None,
                # Its index holds no features without a geometry, which empty cells have.
                layer_options={"SPATIAL_INDEX": "NO"} if ending == ".fgb" and missing else {},
            )
    except (Error, ImportError, MemoryError):
        raise
    except Exception as error:
        said = " ".join(str(error).replace(target, name).split())
        raise BadFile(said if said.startswith(name) else f"{name}: {said}") from None


def _layer_of(table: Any, where: str) -> tuple[str, Any]:
    """The one type of all geometries of a table, which a layer has: polygons beside multipolygons
    become those."""
    pyarrow: Any = importlib.import_module("pyarrow")
    place = table.schema.get_field_index(where)
    shapes = table.column(place).to_pylist()
    kinds = {int.from_bytes(shape[1:5], "little") % 1000 for shape in shapes if shape}
    flags = {int.from_bytes(shape[1:5], "little") & 0x80000000 for shape in shapes if shape}
    has_z = any(flags) or any(
        int.from_bytes(shape[1:5], "little") % 10000 > 1000 for shape in shapes if shape
    )
    if kinds <= {_POLYGON, 6} and 6 in kinds:
        head = b"\x01" + (6).to_bytes(4, "little") + (1).to_bytes(4, "little")
        shapes = [
            head + shape if shape and int.from_bytes(shape[1:5], "little") == _POLYGON else shape
            for shape in shapes
        ]
        field = table.schema.field(place)
        column = pyarrow.array(shapes, type=field.type)
        table = table.set_column(place, field, column)
        kinds = {6}
    name = _NAMES[kinds.pop()] if len(kinds) == 1 else "Unknown"
    return name + (" Z" if has_z and name != "Unknown" else ""), table
