"""The binary column of an Arrow C stream, batch by batch, without pyarrow.

The structures are those of Arrow's C data interface and C stream interface, as its specification
has them: https://arrow.apache.org/docs/format/CDataInterface.html.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import Any

import numpy as np
import numpy.typing as npt

#: Where each value of a batch begins and ends, and the bytes of all values; of a missing one none.
Batch = tuple[npt.NDArray[np.int64], npt.NDArray[np.uint8]]

_Pointer = ctypes.c_void_p


class _Schema(ctypes.Structure):
    pass


class _Array(ctypes.Structure):
    pass


_Release = ctypes.CFUNCTYPE(None, _Pointer)

_Schema._fields_ = [
    ("format", ctypes.c_char_p),
    ("name", ctypes.c_char_p),
    ("metadata", _Pointer),
    ("flags", ctypes.c_int64),
    ("n_children", ctypes.c_int64),
    ("children", ctypes.POINTER(ctypes.POINTER(_Schema))),
    ("dictionary", _Pointer),
    ("release", _Release),
    ("private_data", _Pointer),
]
_Array._fields_ = [
    ("length", ctypes.c_int64),
    ("null_count", ctypes.c_int64),
    ("offset", ctypes.c_int64),
    ("n_buffers", ctypes.c_int64),
    ("n_children", ctypes.c_int64),
    ("buffers", ctypes.POINTER(_Pointer)),
    ("children", ctypes.POINTER(ctypes.POINTER(_Array))),
    ("dictionary", _Pointer),
    ("release", _Release),
    ("private_data", _Pointer),
]


class _Stream(ctypes.Structure):
    _fields_ = [
        ("get_schema", ctypes.CFUNCTYPE(ctypes.c_int, _Pointer, ctypes.POINTER(_Schema))),
        ("get_next", ctypes.CFUNCTYPE(ctypes.c_int, _Pointer, ctypes.POINTER(_Array))),
        ("get_last_error", ctypes.CFUNCTYPE(ctypes.c_char_p, _Pointer)),
        ("release", _Release),
        ("private_data", _Pointer),
    ]


def binary_batches(source: Any) -> Iterator[Batch]:
    """The values of the first column of bytes of an object with ``__arrow_c_stream__``.

    Nothing if there is no such column. Between two batches Ctrl-C is heard. Raises OSError with the
    stream's message.
    """
    capsule = source.__arrow_c_stream__()
    pointer_of = ctypes.pythonapi.PyCapsule_GetPointer
    pointer_of.restype, pointer_of.argtypes = _Pointer, [ctypes.py_object, ctypes.c_char_p]
    address = pointer_of(capsule, b"arrow_array_stream")
    stream = ctypes.cast(address, ctypes.POINTER(_Stream)).contents
    place, wide = _binary_column(stream, address)
    while place >= 0:
        array = _Array()
        _check(stream, address, stream.get_next(address, ctypes.byref(array)))
        if not array.release:  # the end
            return
        try:
            yield _values(array, place, wide)
        finally:
            array.release(ctypes.addressof(array))
    # The capsule releases the stream.


def _check(stream: _Stream, address: Any, status: int) -> None:
    if status:
        said = stream.get_last_error(address)
        raise OSError((said or b"the file cannot be read").decode(errors="replace"))


def _binary_column(stream: _Stream, address: Any) -> tuple[int, bool]:
    """Its place among the columns, -1 if there is none, and whether its offsets have 64 bits."""
    schema = _Schema()
    _check(stream, address, stream.get_schema(address, ctypes.byref(schema)))
    try:
        formats = [schema.children[i].contents.format for i in range(schema.n_children)]
    finally:
        schema.release(ctypes.addressof(schema))
    for place, kind in enumerate(formats):
        if kind in (b"z", b"Z"):
            return place, kind == b"Z"
    return -1, False


def _values(table: _Array, place: int, wide: bool) -> Batch:
    """Copies, so that they outlive the batch."""
    column = table.children[place].contents
    count, first = column.length, column.offset
    if count == 0:
        return np.zeros(1, dtype=np.int64), np.empty(0, dtype=np.uint8)
    _, offsets_at, data_at = (column.buffers[i] for i in range(3))
    kind: Any = ctypes.c_int64 if wide else ctypes.c_int32
    offsets_of = ctypes.cast(offsets_at, ctypes.POINTER(kind))
    offsets = np.ctypeslib.as_array(offsets_of, (first + count + 1,))[first:].astype(np.int64)
    if (np.diff(offsets) < 0).any():
        raise OSError("the values of the Arrow stream overlap")
    begin, end = int(offsets[0]), int(offsets[-1])
    if begin == end:
        return offsets - begin, np.empty(0, dtype=np.uint8)
    bytes_at = ctypes.cast(data_at, ctypes.POINTER(ctypes.c_uint8))
    data = np.ctypeslib.as_array(bytes_at, (end,))[begin:].copy()
    return offsets - begin, data
