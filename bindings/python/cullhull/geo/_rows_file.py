"""Points that come in blocks, as a file that the program maps: memory holds one block."""

from __future__ import annotations

import itertools
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from .._errors import BadFile

Blocks = Iterable[npt.NDArray[Any]]
#: Bytes of a file's head, which is written twice: the count of points is known at the end.
_HEAD = 256


def write_npy(path: Path, blocks: Blocks, name: str) -> None:
    """As .npy, of the type of the first block. `name`: of what is read, for errors."""
    _write(path, blocks, name, _npy_head)


def write_ply(path: Path, blocks: Blocks, name: str) -> None:
    """As .ply of doubles, whose columns are named x, y and z: of 2D and 3D points."""
    doubles = (np.asarray(block, dtype="<f8") for block in blocks)
    _write(path, doubles, name, lambda _, count, width: _ply_head(count, width))


def _write(path: Path, blocks: Blocks, name: str, head: Any) -> None:
    blocks = iter(blocks)
    first = next(blocks, None)
    if first is None:
        raise BadFile(f"{name}: no points")
    kind, width, count = first.dtype, first.shape[1], 0
    with open(path, "wb") as file:
        file.write(bytes(_HEAD))
        for block in itertools.chain([first], blocks):
            if block.shape[1] != width:
                raise BadFile(f"{name}: points of {width} and of {block.shape[1]} coordinates")
            file.write(np.ascontiguousarray(block, dtype=kind).data)
            count += len(block)
        file.seek(0)
        file.write(head(kind, count, width))


def _npy_head(kind: Any, count: int, width: int) -> bytes:
    said = {"descr": kind.str, "fortran_order": False, "shape": (count, width)}
    text = repr(said).encode().ljust(_HEAD - 11) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text


def _ply_head(count: int, width: int) -> bytes:
    axes = "".join(f"property double {axis}\n" for axis in "xyz"[:width])
    begin = "ply\nformat binary_little_endian 1.0\ncomment "
    end = f"\nelement vertex {count}\n{axes}end_header\n"
    return begin.encode().ljust(_HEAD - len(end), b"-") + end.encode()
