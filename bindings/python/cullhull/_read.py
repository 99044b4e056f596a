"""Points from files: by the program's own readers, or by Python packages (LAZ, E57, Parquet, HDF5,
Zarr)."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from . import _core
from ._arguments import as_count
from ._errors import BadFile, InvalidArgument, ShapeWarning, warn

Columns = Union[Sequence[str], Sequence[int], None]
#: Points read at a time by a package that gives no view of all.
_MANY = 1 << 20


def read(
    path: str | os.PathLike[str],
    *,
    columns: Columns = None,
    chunks: int | None = None,
) -> Any:
    """The points of a file.

    .npy, .ply, .las, .pcd, .obj, .off, .stl, .xyz, .txt and .csv, and these compressed (.gz, .zst,
    .npz) need no other package; what holds records of numbers is mapped, and the array is a view of
    the file that is not to be changed meanwhile. .laz and COPC need laspy (``pip install
    laspy[lazrs]``), .e57 pye57, .parquet pyarrow, FOLDER.zarr or FOLDER.zarr/NAME (an array) zarr,
    FILE.h5:/GROUP/NAME (a dataset) h5py. .las and .laz give the file's whole numbers, to which its
    scale and offset are not applied, so that a hull of them is exact.

    Names with a protocol (``s3://bucket/a.parquet``) are opened by fsspec: .npy, .las, .laz, .parquet,
    .zarr and .h5.

    Parameters
    ----------
    path : str or path
    columns : names or numbers, optional
        Which coordinates: numbers, or names where the file has some (a text's first line, x, y, z
        of meshes and scans, Parquet). By default x, y, z where there are columns so named, else
        all; a text of which columns are left out so gives a `ShapeWarning`.
    chunks : int, optional
        At most so many points at a time: an iterator of arrays instead of one. Text and what is
        compressed is read whole all the same.

    Returns
    -------
    (n, d) array, or an iterator of them

    Raises
    ------
    BadFile, InvalidArgument (ValueErrors), OSError
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
    name = os.fspath(path)
    ending = os.path.splitext(name)[1].lower()
    if re.search(r"\.(h5|hdf5|he5|nc|nc4)(:|$)", name, re.IGNORECASE):
        ending = ".h5"
    if re.search(r"\.zarr(/|$)", name, re.IGNORECASE):
        ending = ".zarr"
    remote = "://" in name
    reader = _READERS.get(ending, _native)
    if ending == ".las" and not remote:
        reader = _native
    if remote and reader is _native:
        raise BadFile(f"{name}: by fsspec read reads {' '.join(_READERS)}")
    pieces = reader(name, columns, size)
    if size is not None:
        return pieces
    parts = list(pieces)
    if not parts:
        raise BadFile(f"{name}: no points")
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _package(name: str, ending: str, install: str) -> Any:
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError(
            f"{ending} are read with {name}, which is not installed: pip install {install}"
        ) from None


def _opened(name: str) -> Any:
    """What a reader is given: the name of a file here, or an open file from elsewhere."""
    if "://" not in name:
        return name
    return _package("fsspec", "files with a protocol", "fsspec").open(name, "rb").open()


def _numbers(columns: Columns, width: int, name: str) -> list[int]:
    if columns is None:
        return list(range(width))
    numbers = [c for c in columns if isinstance(c, (int, np.integer)) and 0 <= c < width]
    if len(numbers) != len(columns) or not numbers:
        raise InvalidArgument(f"{name}: columns must be numbers from 0 to {width - 1}")
    return [int(c) for c in numbers]


def _blocks(array: Any, size: int | None) -> Iterator[npt.NDArray[Any]]:
    for start in range(0, max(1, array.shape[0]), size or max(1, array.shape[0])):
        yield np.asarray(array[start : start + size] if size else array[:])


def _slices(array: Any, columns: Columns, size: int | None, name: str) -> Iterator[npt.NDArray[Any]]:
    if array.ndim != 2:
        raise BadFile(f"{name}: array of {array.ndim} axes; points need (n, d)")
    taken = _numbers(columns, array.shape[1], name)
    for block in _blocks(array, size):
        yield block if columns is None else block[:, taken]


def _native(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    wanted = ",".join(f'"{c}"' if isinstance(c, str) else str(int(c)) for c in columns or ())
    array, remarks = _core.read_points(name, wanted)
    for line in remarks:
        warn(line, ShapeWarning)
    yield from _blocks(array, size)


def _npy(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    file = _opened(name)
    mode: Any = "r" if file is name else None
    return _slices(np.load(file, mmap_mode=mode), columns, size, name)


def _hdf5(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    h5py = _package("h5py", ".h5 files", "h5py")
    path, dataset = name, ""
    found = re.search(r"\.(h5|hdf5|he5|nc|nc4):", name, re.IGNORECASE)
    if found and not os.path.exists(name):
        path, dataset = name[: found.end() - 1], name[found.end() :]
    with h5py.File(_opened(path), "r") as file:
        arrays: list[str] = []

        def note(where: str, item: Any) -> None:
            if isinstance(item, h5py.Dataset) and item.ndim == 2 and item.dtype.kind in "fiu":
                arrays.append("/" + where)

        file.visititems(note)
        if not dataset and len(arrays) == 1:
            dataset = arrays[0]
        if not isinstance(file.get(dataset) if dataset else None, h5py.Dataset):
            raise InvalidArgument(
                f"{path}: say which dataset, as FILE.h5:/NAME; there are {', '.join(arrays)}"
            )
        yield from _slices(file[dataset], columns, size, name)


def _zarr(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    array = _package("zarr", ".zarr folders", "zarr").open(name, mode="r")
    if not hasattr(array, "ndim"):
        names = ", ".join(sorted(array.array_keys()))
        raise InvalidArgument(f"{name}: say which array, as FOLDER.zarr/NAME; there are {names}")
    return _slices(array, columns, size, name)


def _las(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    laspy = _package("laspy", ".las and .laz files", "'laspy[lazrs]'")
    taken = _numbers(columns, 3, name)
    try:
        with laspy.open(_opened(name)) as file:
            for points in file.chunk_iterator(size or _MANY):
                axes = (points.X, points.Y, points.Z)
                yield np.column_stack([np.asarray(axes[j], dtype=np.int32) for j in taken])
    except laspy.errors.LaspyException as error:
        raise BadFile(f"{name}: {error}") from None


def _e57(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    pye57 = _package("pye57", ".e57 files", "pye57")
    taken = _numbers(columns, 3, name)
    try:
        with pye57.E57(name) as file:
            for scan in range(file.scan_count):
                axes = file.read_scan(scan, ignore_missing_fields=True)
                rows = np.column_stack([axes[f"cartesian{'XYZ'[j]}"] for j in taken])
                yield from _blocks(rows, size)
    except pye57.libe57.E57Exception as error:
        raise BadFile(f"{name}: {error}") from None


def _parquet(name: str, columns: Columns, size: int | None) -> Iterator[npt.NDArray[Any]]:
    parquet = _package("pyarrow.parquet", ".parquet files", "pyarrow")
    file = parquet.ParquetFile(_opened(name))
    names = list(file.schema_arrow.names)
    if columns is None:
        xyz = [c for c in "xyz" if c in names]
        wanted = xyz if len(xyz) >= 2 else names
    elif all(isinstance(c, str) for c in columns):
        wanted = [str(c) for c in columns]
    else:
        wanted = [names[j] for j in _numbers(columns, len(names), name)]
    missing = [c for c in wanted if c not in names]
    if missing:
        raise InvalidArgument(f"{name}: no column {missing[0]!r}; there are {', '.join(names)}")
    for batch in file.iter_batches(batch_size=size or _MANY, columns=wanted):
        for column in wanted:
            if batch.column(column).null_count:
                raise BadFile(f"{name}: column {column!r} has missing values")
        yield np.column_stack(
            [batch.column(column).to_numpy(zero_copy_only=False) for column in wanted]
        )


_READERS = {
    ".npy": _npy,
    ".las": _las,
    ".laz": _las,
    ".e57": _e57,
    ".parquet": _parquet,
    ".zarr": _zarr,
    ".h5": _hdf5,
}
