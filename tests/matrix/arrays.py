"""The doors of Python: what users hold points in, as expressions of `a`, the (n, d) doubles."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Callable, Optional

import numpy as np

from doors import always, both, fitting
from sets import PointSet


class OnlyInterface:
    """An object that knows NumPy's protocol and nothing else."""

    def __init__(self, array: Any) -> None:
        self._array = array

    def __array__(self, dtype: Any = None, copy: Any = None) -> Any:
        return self._array if dtype is None else self._array.astype(dtype)


class OnlyDlpack:
    """An object that knows DLPack and nothing else."""

    def __init__(self, array: Any) -> None:
        self._array = array

    def __dlpack__(self, **kind: Any) -> Any:
        return self._array.__dlpack__(**kind)

    def __dlpack_device__(self) -> Any:
        return self._array.__dlpack_device__()


def frozen(array: Any) -> Any:
    copy = array.copy()
    copy.flags.writeable = False
    return copy


def unaligned(array: Any) -> Any:
    raw = np.zeros(array.nbytes + 1, np.uint8)
    view = raw[1:].view(np.float64).reshape(array.shape)
    view[...] = array
    return view


def fields(array: Any) -> Any:
    """The coordinates within records that hold more."""
    records = np.zeros(
        len(array), np.dtype([("id", "<i8"), ("at", "<f8", array.shape[1]), ("w", "<f4")])
    )
    records["at"] = array
    return records["at"]


def read_back(array: Any, ending: str) -> Any:
    """What `cullhull.read` gives of a file that another package wrote."""
    import tempfile

    import cullhull

    with tempfile.TemporaryDirectory() as folder:
        path = f"{folder}/points{ending}"
        _WRITERS[ending](path, array)
        return np.array(cullhull.read(path))


def _write_vector(path: str, array: Any) -> None:
    import pyogrio
    import shapely

    kind = "Point" if array.shape[1] == 2 else "Point Z"
    geometries = shapely.to_wkb(shapely.points(array), output_dimension=3)
    # FlatGeobuf's index would put the points in another order.
    options = {"SPATIAL_INDEX": "NO"}
    pyogrio.raw.write(
        path, geometries, [np.arange(len(array))], ["n"],
        geometry_type=kind, crs="EPSG:25832", layer_options=options,
    )  # fmt: skip


def _write_parquet(path: str, array: Any) -> None:
    import pyarrow
    import pyarrow.parquet

    table = pyarrow.table({n: c for n, c in zip(names(array), array.T.copy())})
    pyarrow.parquet.write_table(table, path)


def _write_e57(path: str, array: Any) -> None:
    import pye57

    with pye57.E57(path, mode="w") as file:
        file.write_scan_raw({f"cartesian{'XYZ'[j]}": array[:, j].copy() for j in range(3)})


_WRITERS = {".fgb": _write_vector, ".parquet": _write_parquet, ".e57": _write_e57}


def names(array: Any) -> list[str]:
    return [f"x{i}" for i in range(array.shape[1])]


@dataclass(frozen=True)
class Array:
    name: str
    text: str  #: of `a`; pd, pl, pa and np are the packages
    reason: Callable[[PointSet], Optional[str]] = always
    package: str = "numpy"
    #: The class of the error with which it is refused, if it is.
    refused: Optional[str] = None


def with_rows(s: PointSet) -> Optional[str]:
    return None if s.count else "an empty list has no second axis"


def as_geometries(s: PointSet) -> Optional[str]:
    if s.dimension not in (2, 3):
        return "geometries are of 2 or 3 coordinates"
    if not s.finite:
        return "Shapely takes a point that is not finite for an empty one"
    return None if s.count else "a geometry without points has no dimension"


def in_space(s: PointSet) -> Optional[str]:
    if s.dimension != 3:
        return "trimesh has points of space"
    return None if s.finite and s.count else "trimesh drops such points itself"


def with_points(s: PointSet) -> Optional[str]:
    return None if s.count else "a file without points is refused"


def in_scans(s: PointSet) -> Optional[str]:
    if s.dimension != 3 or not s.count:
        return "E57 holds points of space, at least one"
    return None if s.finite else "E57 files have bounds of all points"


def zeros_and_ones(s: PointSet) -> Optional[str]:
    held = s.finite and set(np.unique(s.points)) <= {0.0, 1.0}
    return None if held and not s.has_minus_zero else "not all coordinates are 0 or 1"


ARRAYS = (
    Array("array", "a"),
    Array("fortran", "np.asfortranarray(a)"),
    Array("strided", "np.repeat(np.repeat(a, 2, axis=0), 3, axis=1)[::2, ::3]"),
    Array("reversed", "a[::-1, ::-1].copy()[::-1, ::-1]"),
    Array("read-only", "frozen(a)"),
    Array("unaligned", "unaligned(a)"),
    Array("fields", "fields(a)"),
    Array("big-endian", "a.astype('>f8')"),
    Array("longdouble", "a.astype(np.longdouble)"),
    *(
        Array(t, f"a.astype('{t}')", fitting(t))
        for t in ("f4", "f2", "i1", "u1", "i2", "u2", "i4", "u4", "i8", "u8")
    ),
    Array("bool", "a.astype(bool)", zeros_and_ones),
    Array("list", "a.tolist()", with_rows),
    Array("tuples", "tuple(map(tuple, a.tolist()))", with_rows),
    Array("rows", "list(a)", with_rows),
    Array("interface", "OnlyInterface(a)"),
    Array("dlpack", "OnlyDlpack(a)"),
    Array("matrix", "np.asmatrix(a)"),
    Array("pandas", "pd.DataFrame(a)", package="pandas"),
    Array("pandas-f4", "pd.DataFrame(a.astype('f4'))", fitting("f4"), package="pandas"),
    Array(
        "pandas-mixed",
        "pd.DataFrame({n: c.astype('i4' if i else 'f8') "
        "for i, (n, c) in enumerate(zip(names(a), a.T))})",
        fitting("i4"),
        package="pandas",
    ),
    Array(
        "pandas-nullable", "pd.DataFrame(a, columns=names(a)).astype('Float64')", package="pandas"
    ),
    Array("polars", "pl.DataFrame({n: c for n, c in zip(names(a), a.T.copy())})", package="polars"),
    Array(
        "polars-f4",
        "pl.DataFrame({n: c.astype('f4') for n, c in zip(names(a), a.T)})",
        fitting("f4"),
        package="polars",
    ),
    Array("pyarrow", "pa.table({n: c for n, c in zip(names(a), a.T.copy())})", package="pyarrow"),
    Array(
        "pyarrow-chunks",
        "pa.concat_tables([pa.table({n: c[i:i + 5] for n, c in "
        "zip(names(a), a.T.copy())}) for i in range(0, len(a), 5)])",
        lambda s: None if s.count else "no chunks",
        package="pyarrow",
    ),
    Array(
        "pyarrow-i2",
        "pa.table({n: c.astype('i2') for n, c in zip(names(a), a.T)})",
        fitting("i2"),
        package="pyarrow",
    ),
    Array("multipoint", "shapely.MultiPoint(a)", as_geometries, package="shapely"),
    Array("points", "list(shapely.points(a))", as_geometries, package="shapely"),
    Array("geoseries", "geopandas.GeoSeries(shapely.points(a))", as_geometries, package="geopandas"),
    Array(
        "geodataframe",
        "geopandas.GeoDataFrame({'n': np.arange(len(a))}, geometry=shapely.points(a))",
        as_geometries,
        package="geopandas",
    ),
    Array("trimesh", "trimesh.PointCloud(a)", in_space, package="trimesh"),
    Array("fgb", "read_back(a, '.fgb')", as_geometries, package="pyogrio"),
    Array("parquet", "read_back(a, '.parquet')", with_points, package="pyarrow"),
    Array("e57", "read_back(a, '.e57')", both(in_scans, fitting("f4")), package="pye57"),
    Array("objects", "a.astype(object)", refused="TypeError"),
    Array("complex", "a.astype(complex)", refused="TypeError"),
    Array("masked", "np.ma.masked_array(a)", refused="InvalidArgument"),
)

#: Doors of a short run for functions that take points as another one does.
FEW_ARRAYS = ("fortran", "strided", "f4", "i2", "list", "pandas", "pyarrow")
