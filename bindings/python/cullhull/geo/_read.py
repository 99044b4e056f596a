"""Points from files: by the program's own readers, or by Python packages (E57, Parquet, HDF5, Zarr,
 GeoPackage and other vector files)."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from .. import _core
from .._arguments import as_count
from .._errors import BadFile, Error, InvalidArgument, ShapeWarning, warn
from .._extras import needed
from . import _e57, _vectors
from ._columns import faults_of_a_package, side_by_side
from ._parquet import Taken, choose, coordinates_of, peek_of

Columns = Union[str, Sequence[str], Sequence[int], None]
#: Points read at a time by a package that gives no view of all.
_MANY = 1 << 20


def read(
    path: str | os.PathLike[str],
    *,
    columns: Columns = None,
    chunks: int | None = None,
    raw: bool = False,
    skip_nan: bool = False,
    return_rows: bool = False,
    decimal: str | None = None,
) -> Any:
    """The points of a file.

    .npy, .ply, .las, .laz (COPC, too), .pcd, .obj, .off, .stl, .xyz, .txt, .csv, .pts, .ptx, .node, .asc, .geojson
    and .wkt, and these compressed (.gz, .zst, .npz) need no other package; what holds records of
    numbers is mapped, and the array is a view of the file that is not to be changed meanwhile. .e57 needs pye57 (extra ``e57``), .parquet pyarrow (``parquet``), FOLDER.zarr or
    FOLDER.zarr/NAME (an array) zarr (``zarr``), FILE.h5:/GROUP/NAME (a dataset) or FILE.nc:x,y,z (a
    column each) h5py (``hdf5``); NetCDF of the classic format needs SciPy. .gpkg (also FILE.gpkg:LAYER), .shp, .fgb, .gml and .kml need
    pyogrio and pyarrow (``vector``); the points are the vertices of all geometries, without the
    last one of a ring, which is its first again.

    .las and .laz give coordinates as doubles: if scale and offset are decimals the doubles nearest
    to number * scale + offset, else what laspy computes. The two differ by laspy's roundings.

    Names with a protocol (``s3://bucket/a.parquet``) are opened by fsspec (extra ``remote``):
    .npy, .las, .laz, .parquet, .zarr and .h5. There .las and .laz need laspy (``laz``).

    Parameters
    ----------
    path : str or path
    columns : names or numbers, optional; or both joined by commas
        Which coordinates: numbers from 0, in a text also ranges of them (``"0:3"``, ``"0,2,5"``),
        or names where the file has some (a text's first line, x, y, z of meshes and scans,
        Parquet). By default x, y, z where there are columns so named in either
        case, else lon and lat, longitude and latitude, or easting and northing, perhaps with a
        height, in several languages and spellings; a text whose names are not known as coordinates
        is refused, unless they are a series such as x0, x1, x2. Of GeoParquet the primary column
        comes first: the vertices of all its geometries, as of other vector files, without rows that
        have none. Of other Parquet, where no columns are so named, the one column of geometries in
        WKB or of lists of numbers comes first, else all but id, index, fid and columns without a
        name. A `ShapeWarning` says which columns were chosen or left out, and what else the reader
        passed over, such as faces that are cut short.
    chunks : int, optional
        The most points at a time: an iterator of arrays instead of one. Text and what is
        compressed is read whole all the same.
    raw : bool
        The whole numbers of a .las or .laz as they are in the file, without its scale and offset:
        .las in place.
    skip_nan : bool
        Leave out points with a NaN coordinate, which is how scanners mark pulses without a return.
        A `ShapeWarning` says how many.
    return_rows : bool
        Also return the number in the file of each point, from 0: the ids that its points have for
        the program, and with `skip_nan` the way back from a hull's ids to the file.
    decimal : "," or ".", optional
        The decimal mark of the numbers in a text. By default commas are decimal marks where
        semicolons, tabs or the columns' names leave no other meaning, which a `ShapeWarning` says.

    Returns
    -------
    (n, d) array, or an iterator of them; with `return_rows` pairs of an array and its (n,) rows

    Raises
    ------
    BadFile, InvalidArgument (ValueErrors), OSError
        BadFile also for a 64-bit integer beside columns of doubles that no double equals.
    ImportError
        Where the format's package is not installed; it says which.

    Examples
    --------
    >>> import cullhull, numpy, os, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = os.path.join(folder, "points.npy")
    ...     numpy.save(path, cullhull.generate("ball", 1000))
    ...     stream = cullhull.HullStream()
    ...     stream.extend(cullhull.read(path, chunks=100))
    >>> stream.point_count
    1000
    """
    size = None if chunks is None else as_count(chunks, "chunks", least=1)
    if decimal not in (None, ",", "."):
        raise InvalidArgument(f"`decimal` should be ',' or '.'; it is {decimal!r}")
    if isinstance(columns, str):
        columns = split_columns(columns)
    name = os.fspath(path)
    ending = os.path.splitext(name)[1].lower()
    if re.search(r"\.(h5|hdf5|he5|nc|nc4)(:|$)", name, re.IGNORECASE):
        ending = ".h5"
    if re.search(r"\.zarr(/|$)", name, re.IGNORECASE):
        ending = ".zarr"
    if _vectors.split_layer(name)[1] is not None and not os.path.exists(name):
        ending = ".gpkg"
    remote = "://" in name
    reader = _READERS.get(ending, _native)
    if ending in (".las", ".laz") and not remote:
        reader = _native
    if remote and reader in (_native, _e57_scans, _vector):
        known = [e for e, of in _READERS.items() if of not in (_e57_scans, _vector)]
        raise BadFile(f"{name}: by fsspec read reads {' '.join(known)}")
    if decimal == "," and reader is not _native:
        raise InvalidArgument(f"{name}: only texts of rows have decimal commas")
    if reader is _native:
        pieces = _native(name, columns, size, raw, decimal or "")
    elif reader is _las:
        pieces = _las(name, columns, size, raw)
    else:
        pieces = _said_once(reader, name, columns, size, ending)
    numbered = _numbered(pieces, name, skip_nan)
    if size is not None:
        return numbered if return_rows else (points for points, _ in numbered)
    parts = list(numbered)
    if not parts:
        raise BadFile(f"{name}: no points")
    points = parts[0][0] if len(parts) == 1 else np.concatenate([points for points, _ in parts])
    if not return_rows:
        return points
    return points, np.concatenate([rows for _, rows in parts])


def _numbered(
    pieces: Iterator[npt.NDArray[Any]], name: str, skip_nan: bool
) -> Iterator[tuple[npt.NDArray[Any], npt.NDArray[np.int64]]]:
    """Blocks with the numbers of their points in the file; without points that have a NaN."""
    first = skipped = 0
    for block in pieces:
        rows = np.arange(first, first + len(block))
        first += len(block)
        if skip_nan and block.dtype.kind == "f":
            kept = ~np.isnan(block).any(axis=1)
            if not kept.all():
                skipped += len(block) - int(kept.sum())
                block, rows = block[kept], rows[kept]
        yield block, rows
    if skipped:
        warn(f"{name}: {skipped} of {first} points have a NaN coordinate and are skipped",
             ShapeWarning)


def _said_once(
    reader: Any, name: str, columns: Columns, size: int | None, ending: str
) -> Iterator[npt.NDArray[Any]]:
    """What another package raises for a damaged file as one line of ours; what the system refuses,
    a package that is missing and what the caller raises as they are."""
    try:
        yield from reader(name, columns, size)
    except (Error, ImportError, MemoryError, Warning):
        raise
    except OSError as error:
        # Windows reports an array that ends beyond its file as a lack of memory.
        if error.errno is not None and getattr(error, "winerror", None) != 8:
            raise
        raise _damaged(name, ending, error) from error
    except Exception as error:
        raise _damaged(name, ending, error) from error


def _damaged(name: str, ending: str, error: Exception) -> BadFile:
    reason = str(error).strip().split("\n")[0]
    if not reason or "pickle" in reason:  # NumPy advises to run what the file holds
        reason = "it holds no array of numbers"
    return BadFile(f"{name}: damaged, or no {ending} file: {reason}")


def split_columns(text: str) -> list[Any]:
    """Names, numbers and ranges as the program takes them: ``x,"a, b",0,2:5``."""
    found: list[Any] = []
    for quoted, word in re.findall(r'\s*(?:"([^"]*)"\s*(?=,|$)|([^,]*))(?:,|$)', text + ","):
        word = word.strip()
        span = re.fullmatch(r"([0-9]+):([0-9]+)", word)
        if quoted:
            found.append(quoted)
        elif span:
            found += range(int(span[1]), int(span[2]))
        elif re.fullmatch("[0-9]+", word):
            found.append(int(word))
        elif word:
            found.append(word)
    if not found:
        raise InvalidArgument(f"columns {text!r} names no column")
    return found


def _opened(name: str) -> Any:
    """What a reader is given: the name of a file here, or an open file from elsewhere."""
    if "://" not in name:
        return name
    return needed("fsspec", "reading names with a protocol", "remote").open(name, "rb").open()


def _numbers(columns: Columns, width: int, name: str, names: str = "") -> list[int]:
    """`names`: of the columns, a letter each, which are known in either case."""
    if columns is None:
        return list(range(width))
    if names:
        for c in columns:
            if isinstance(c, str) and (len(c) != 1 or c.lower() not in names):
                raise InvalidArgument(f"{name}: no column {c!r}; there are {', '.join(names)}")
        columns = [names.index(c.lower()) if isinstance(c, str) else c for c in columns]
    numbers = [c for c in columns if isinstance(c, (int, np.integer)) and 0 <= c < width]
    if len(numbers) != len(columns) or not numbers:
        raise InvalidArgument(f"{name}: columns must be numbers from 0 to {width - 1}")
    _refuse_repeated(numbers, name)
    return [int(c) for c in numbers]


def _refuse_repeated(columns: Sequence[Any], name: str) -> None:
    """As the library does for the files that it reads itself."""
    for i, c in enumerate(columns):
        if c in columns[:i]:
            raise InvalidArgument(f"{name}: column {c!r} is named twice")


def _blocks(array: Any, size: int | None) -> Iterator[npt.NDArray[Any]]:
    for start in range(0, max(1, array.shape[0]), size or max(1, array.shape[0])):
        yield np.asarray(array[start : start + size] if size else array[:])


def _slices(array: Any, columns: Columns, size: int | None, name: str) -> Iterator[npt.NDArray[Any]]:
    if array.ndim == 1:  # n points of a line, as the program reads them
        taken = _numbers(columns, 1, name)
        for block in _blocks(array, size):
            yield block[:, None]
        return
    if array.ndim != 2:
        raise BadFile(f"{name}: array of {array.ndim} axes; points need (n, d)")
    taken = _numbers(columns, array.shape[1], name)
    for block in _blocks(array, size):
        yield block if columns is None else block[:, taken]


def _native_column(column: Any) -> str:
    """As the library takes it: a name in quotes, a number, a range without one of its ends."""
    if not isinstance(column, str):
        return str(int(column))
    return column if re.fullmatch("[0-9]+:|:[0-9]+", column) else f'"{column}"'


def _native(
    name: str, columns: Columns, size: int | None, raw: bool = False, decimal: str = ""
) -> Iterator[npt.NDArray[Any]]:
    wanted = ",".join(map(_native_column, columns or ()))
    array, remarks, scale, offset = _core.read_points(name, wanted, raw, size is not None, decimal)
    for line in remarks:
        warn(line, ShapeWarning)
    if size is None or raw or not scale:
        yield from _blocks(array, size)
        return
    place = _Placing(scale, offset)  # a block at a time: the file stays mapped
    for block in _blocks(array, size):
        yield np.column_stack([place(j, block[:, j]) for j in range(len(scale))])


def _npy(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    file = _opened(name)
    mode: Any = "r" if file is name else None
    array = np.load(file, mmap_mode=mode)
    if array.dtype.names:
        return _structured(array, columns, size, name)
    return _slices(array, columns, size, name)


def _structured(
    array: Any, columns: Columns, size: int | None, name: str
) -> Iterator[npt.NDArray[Any]]:
    """Fields of a structured array, as PDAL and pyntcloud write it, by the rule of Parquet's
    columns: x, y and z, longitude and latitude, ... in either case, or those that are named."""
    if array.ndim != 1:
        raise BadFile(f"{name}: structured array of {array.ndim} axes; points need one")
    dtype = array.dtype
    fields = [f for f in dtype.names if dtype[f].shape == () and dtype[f].kind in "fiu"]
    known = coordinates_of(fields)
    if columns is None and not known:
        which = "; columns= says which are the coordinates"
        listed = ", ".join(map(repr, fields)) + which if fields else "none is a number"
        raise BadFile(f"{name}: a structured array whose fields name no x and y: {listed}")
    numbered = known or fields
    wanted = []
    for c in range(len(known)) if columns is None else columns:
        if isinstance(c, str):
            same = [f for f in fields if f == c] or [f for f in fields if f.lower() == c.lower()]
            if len(same) != 1:
                raise InvalidArgument(f"{name}: no column {c!r}; there are {', '.join(fields)}")
            wanted += same
        else:
            wanted.append(numbered[_numbers([c], len(numbered), name)[0]])
    _refuse_repeated(wanted, name)
    step = size or max(1, len(array))
    for start in range(0, max(1, len(array)), step):
        block = array[start : start + step]
        yield side_by_side([np.asarray(block[f]) for f in wanted], wanted, name, start)


def _hdf5(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    path, dataset = name, ""
    found = re.search(r"\.(h5|hdf5|he5|nc|nc4):", name, re.IGNORECASE)
    if found and not os.path.exists(name):
        path, dataset = name[: found.end() - 1], name[found.end() :]
    classic = None if "://" in path else _classic_netcdf(path, dataset, columns, size)
    if classic is not None:
        yield from classic
        return
    h5py = needed("h5py", "reading .h5 files", "hdf5")
    with h5py.File(_opened(path), "r") as file:
        tables: list[str] = []
        lines: list[str] = []

        def note(where: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu":
                if item.ndim == 2:
                    tables.append("/" + where)
                if item.ndim == 1:
                    lines.append("/" + where)

        file.visititems(note)
        names = _chosen_datasets(path, dataset, tables, lines, lambda n: file.get(n) if n else None)
        found_all = [file.get(n) for n in names]
        if not all(isinstance(found, h5py.Dataset) for found in found_all):
            raise _no_dataset(path, tables + lines)
        for found in found_all:
            _refuse_gaps(h5py, found, path)
        if len(names) == 1:
            yield from _slices(found_all[0], columns, size, name)
            return
        yield from _columns_of(found_all, names, columns, size, path)


def _no_dataset(path: str, known: list[str]) -> InvalidArgument:
    listed = ", ".join(known) if known else "none of numbers"
    several = f", or several columns as in FILE.h5:{','.join(known[:3])}" if len(known) > 1 else ""
    return InvalidArgument(
        f"{path}: say which dataset, as FILE.h5:/NAME{several}; there are {listed}"
    )


def _chosen_datasets(
    path: str, dataset: str, tables: list[str], lines: list[str], find: Callable[[str], Any]
) -> list[str]:
    """The datasets that are named, or the only table (n, d), or the only column (n), as the program
    chooses them."""
    if not dataset and len(tables) == 1:
        return tables
    if not dataset and not tables and len(lines) == 1:
        return lines
    names = dataset.split(",")
    if not dataset or any(find(n) is None for n in names):
        raise _no_dataset(path, tables + lines)
    return names


def _classic_netcdf(
    path: str, dataset: str, columns: Columns, size: int | None
) -> Iterator[npt.NDArray[Any]] | None:
    """NetCDF of the formats before HDF5, by SciPy; None for other files."""
    try:
        with open(path, "rb") as file:
            magic = file.read(4)
    except OSError:
        return None  # h5py says what is wrong
    if magic[:3] != b"CDF" or magic[3:] not in (b"\x01", b"\x02", b"\x05"):
        return None
    advice = "nccopy -k nc4 makes a file of it that is read like HDF5"
    if magic[3:] == b"\x05":
        raise BadFile(f"{path}: NetCDF of the format CDF-5; {advice}")
    try:
        from scipy.io import netcdf_file
    except ImportError:
        raise BadFile(f"{path}: NetCDF of the classic format needs SciPy; or {advice}") from None
    with faults_of_a_package(path, Exception), netcdf_file(path, "r", mmap=False) as opened:
        variables = {n: v.data for n, v in opened.variables.items() if v.data is not None}
    arrays = {n: a for n, a in variables.items() if getattr(a, "dtype", np.dtype("O")).kind in "fiu"}
    tables = [n for n, a in arrays.items() if a.ndim == 2]
    lines = [n for n, a in arrays.items() if a.ndim == 1]
    names = [
        n.lstrip("/")
        for n in _chosen_datasets(
            path, dataset, tables, lines, lambda n: arrays.get(n.lstrip("/"))
        )
    ]
    native = [arrays[n].astype(arrays[n].dtype.newbyteorder("=")) for n in names]
    if len(names) == 1:
        return _slices(native[0], columns, size, path)
    return _columns_of(native, names, columns, size, path)


def _refuse_gaps(h5py: Any, dataset: Any, path: str) -> None:
    """Refuses a dataset that was never written, or not everywhere, and has no fill value."""
    made = dataset.id.get_create_plist()
    known = h5py.h5d  # a damaged file may say what is none of these: then nothing is filled
    filled = made.get_fill_time() in (known.FILL_TIME_ALLOC, known.FILL_TIME_IFSET) and (
        made.fill_value_defined() in (known.FILL_VALUE_DEFAULT, known.FILL_VALUE_USER_DEFINED)
    )
    status = dataset.id.get_space_status()
    if filled or not dataset.size or made.get_external_count() or dataset.is_virtual:
        return
    gap = status == h5py.h5d.SPACE_STATUS_NOT_ALLOCATED
    if status == h5py.h5d.SPACE_STATUS_PART_ALLOCATED and dataset.chunks:
        chunks = 1
        for extent, chunk in zip(dataset.shape, dataset.chunks):
            chunks *= -(-extent // chunk)
        gap = dataset.id.get_num_chunks() < chunks
    if gap:
        raise BadFile(
            f"{path}: dataset {dataset.name!r}: points that were never written, and the dataset "
            "has no fill value"
        )


def _columns_of(
    datasets: list[Any], names: list[str], columns: Columns, size: int | None, path: str
) -> Iterator[npt.NDArray[Any]]:
    """Datasets of one axis and one length, side by side."""
    count = len(datasets[0]) if datasets[0].shape else 0
    for column, column_name in zip(datasets, names):
        if column.ndim != 1 or column.dtype.kind not in "fiu":
            raise BadFile(
                f"{path}: dataset {column_name!r} of {column.shape} is no column of numbers"
            )
        if len(column) != count:
            raise BadFile(
                f"{path}: datasets {names[0]!r} and {column_name!r} have {count} and "
                f"{len(column)} numbers"
            )
    taken = _numbers(columns, len(datasets), path)
    step = size or max(1, count)
    for start in range(0, count, step):
        parts = [datasets[j][start : start + step] for j in taken]
        yield side_by_side(parts, [names[j] for j in taken], path, start)


def _zarr(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    array = needed("zarr", "reading .zarr folders", "zarr").open(name, mode="r")
    if not hasattr(array, "ndim"):
        names = ", ".join(sorted(array.array_keys()))
        raise InvalidArgument(f"{name}: say which array, as FOLDER.zarr/NAME; there are {names}")
    return _slices(array, columns, size, name)


def _las(
    name: str, columns: Columns, size: int | None, raw: bool = False
) -> Iterator[npt.NDArray[Any]]:
    laspy = needed("laspy", "reading .las and .laz files", "laz")
    try:
        with laspy.open(_opened(name)) as file:
            taken = _las_names(columns, list(file.header.point_format.dimension_names), name)
            scale, offset = (
                [float(of["xyz".index(c)]) if c in "xyz" else whole for c in taken]
                for of, whole in ((file.header.scales, 1.0), (file.header.offsets, 0.0))
            )
            if not raw:
                _refuse_unusable(name, file.header)
            place = _Placing([] if raw else scale, offset, exact="gps_time" not in taken)
            if not file.header.point_count:
                yield np.empty((0, len(taken)), dtype=np.int32 if raw else np.float64)
            for points in file.chunk_iterator(size or _MANY):
                columns_of = [np.asarray(points[c.upper() if c in "xyz" else c]) for c in taken]
                yield np.column_stack([place(j, column) for j, column in enumerate(columns_of)])
    except (Error, MemoryError, ImportError, OSError):
        raise
    except BaseException as error:  # a panic of lazrs is no Exception
        if isinstance(error, Exception) or type(error).__name__ == "PanicException":
            raise BadFile(f"{name}: {' '.join(str(error).split())}") from None
        raise


def _las_names(columns: Columns, fields: list[str], name: str) -> list[str]:
    """What columns ask for: x, y and z, by number too, and the fields of a record."""
    axes = ["x", "y", "z"]
    if columns is None or not all(isinstance(c, str) for c in columns):
        return [axes[j] for j in _numbers(columns, 3, name)]
    _refuse_repeated([str(c).lower() for c in columns], name)
    fields = [f for f in fields if f not in ("X", "Y", "Z")]
    known = {f.lower(): f for f in axes + fields}
    for c in columns:
        if str(c).lower() not in known:
            raise InvalidArgument(f"{name}: no column {c!r}; there are {', '.join(known.values())}")
    return [known[str(c).lower()] for c in columns]


def _refuse_unusable(name: str, header: Any) -> None:
    """As the library's reader does for a .las that it reads itself."""
    for axis, scale, offset in zip("xyz", header.scales, header.offsets):
        bad = f"scale of {axis} is {scale:g}" if not 0 < scale < np.inf else ""
        if not bad and not np.isfinite(offset):
            bad = f"offset of {axis} is {offset:g}"
        if bad:
            raise BadFile(
                f"{name}: the {bad}, which gives no coordinates; raw=True reads the stored integers"
            )


class _Placing:
    """From the whole numbers of a scan to coordinates, as the library computes them; unchanged where
    no scale is given. `exact`: whether all numbers are whole."""

    def __init__(self, scale: list[float], offset: list[float], *, exact: bool = True) -> None:
        self._scale, self._offset = scale, offset
        self._decimals = _core.grid_of(scale, offset) if scale and exact else None

    def __call__(self, axis: int, numbers: npt.NDArray[Any]) -> npt.NDArray[Any]:
        if not self._scale:
            return numbers
        scale, offset = self._scale[axis], self._offset[axis]
        whole = np.asarray(numbers, dtype=np.float64)
        result: npt.NDArray[Any]
        if self._decimals is None:
            result = whole * scale + offset
        else:  # exact but for the division
            step, origin = _scaled(scale, self._decimals), _scaled(offset, self._decimals)
            result = (whole * step + origin) / 10.0**self._decimals
        return result


def _scaled(value: float, decimals: int) -> float:
    from decimal import Decimal

    return float(Decimal(repr(value)).scaleb(decimals))


def _e57_scans(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    taken = _numbers(columns, 3, name, "xyz")
    empty = True
    for block in _e57.blocks(name):
        empty = False
        yield from _blocks(block[:, taken], size)
    if empty:
        yield np.empty((0, len(taken)))


def _vector(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    for block in _vectors.blocks(name, size):
        width = block.shape[1]
        yield block if columns is None else block[:, _numbers(columns, width, name, "xyz"[:width])]


def _parquet(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    parquet = needed("pyarrow.parquet", "reading .parquet files", "parquet")
    arrow = needed("pyarrow", "reading .parquet files", "parquet")
    with faults_of_a_package(name, arrow.lib.ArrowException):
        file = parquet.ParquetFile(_opened(name))
        wanted, rows, geometries = choose(name, file.schema_arrow, columns, peek_of(file))
        before: int | None = None
        done = missing = 0
        _refuse_repeated(wanted, name)
        for batch in file.iter_batches(batch_size=size or _MANY, columns=wanted):
            if rows is not None:
                column = batch.column(wanted[0])
                block = _named(name, rows, column, wanted[0], done)
                done += len(batch)
                if geometries:
                    missing += column.null_count
                    if not len(block):
                        continue
                if before not in (None, block.shape[1]):
                    raise BadFile(
                        f"{name}: column {wanted[0]!r}: points of {before} and of "
                        f"{block.shape[1]} coordinates"
                    )
                before = block.shape[1]
                yield from _blocks(block, size)
                continue
            for column in wanted:
                if batch.column(column).null_count:
                    raise BadFile(f"{name}: column {column!r} has missing values")
            parts = [batch.column(column).to_numpy(zero_copy_only=False) for column in wanted]
            yield side_by_side(parts, wanted, name, done)
            done += len(batch)
        if missing:
            have = "has" if missing == 1 else "have"
            warn(f"{name}: {missing} of {done} rows {have} no geometry", ShapeWarning)
        if geometries and before is None:
            yield np.empty((0, 2))


def _named(
    name: str,
    rows: Callable[[Any, str, int], Taken],
    array: Any,
    column: str,
    first: int,
) -> npt.NDArray[Any]:
    try:
        return rows(array, column, first).rows
    except BadFile as error:
        raise BadFile(f"{name}: {error}") from None


_READERS = {
    ".npy": _npy,
    ".las": _las,
    ".laz": _las,
    ".e57": _e57_scans,
    **dict.fromkeys(_vectors.ENDINGS, _vector),
    ".parquet": _parquet,
    ".zarr": _zarr,
    ".h5": _hdf5,
}
