"""The emulated device that cullhull was linked with, by ctypes; as a plugin of pytest it fails each
test in which the device was waited for with the interpreter lock held."""

import ctypes
import gc

import pytest

import cullhull

_library = ctypes.CDLL(cullhull._core.__file__)  # a call by it lets go of the interpreter lock


def _function(name, result, *arguments):
    function = getattr(_library, f"emulated_{name}")
    function.restype, function.argtypes = result, arguments
    return function


_pointer, _size = ctypes.c_void_p, ctypes.c_size_t
waits = _function("waits", ctypes.c_long)
waits_with_lock = _function("waits_with_lock", ctypes.c_long)
allocate = _function("allocate", _pointer, _size)
free = _function("free", None, _pointer)
upload = _function("upload", ctypes.c_int, _pointer, _pointer, _size, _pointer)
download = _function("download", ctypes.c_int, _pointer, _pointer, _size, _pointer)
stream = _function("stream", _pointer)
order = _function("order", ctypes.c_int, _pointer, _pointer)

_function("count_waits", None)()


@pytest.fixture(autouse=True)
def no_wait_with_the_lock_held():
    before = waits_with_lock()
    yield
    gc.collect()
    assert waits_with_lock() == before, "the device was waited for with the interpreter lock held"
