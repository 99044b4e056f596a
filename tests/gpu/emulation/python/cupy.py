"""What tests and recipes use of CuPy, over the emulated device: arrays are in its memory and behind its
streams, operations on them are NumPy's, on copies."""

import ctypes
import functools

import numpy as np

import emulated


class _Memory:
    def __init__(self, bytes):
        self.address = emulated.allocate(max(bytes, 1))
        assert self.address

    def __del__(self):
        emulated.free(self.address)


class cuda:
    class Stream:
        current = None

        def __init__(self, non_blocking):
            assert non_blocking
            self.ptr = emulated.stream()

        def __enter__(self):
            self.before, cuda.Stream.current = cuda.Stream.current, self.ptr

        def __exit__(self, *error):
            cuda.Stream.current = self.before


class ndarray:
    def __init__(self, shape, dtype, strides, address, owner):
        self.shape, self.dtype, self.strides = tuple(shape), np.dtype(dtype), tuple(strides)
        self.address, self.owner = address, owner

    def get(self):
        """A copy on the host."""
        span = sum((n - 1) * step for n, step in zip(self.shape, self.strides)) + self.dtype.itemsize
        bytes = bytearray(0 if 0 in self.shape else span)
        if bytes:
            there = (ctypes.c_char * span).from_buffer(bytes)
            assert emulated.download(there, self.address, span, cuda.Stream.current) == 0
        return np.ndarray(self.shape, self.dtype, bytes, 0, self.strides)

    @property
    def __cuda_array_interface__(self):
        return {
            "shape": self.shape,
            "typestr": self.dtype.str,
            "data": (self.address, False),
            "strides": self.strides,
            "stream": cuda.Stream.current or 1,
            "version": 3,
        }

    def __dlpack__(self, stream=None):
        assert stream > 2, "one of the reader's own"
        assert emulated.order(stream, cuda.Stream.current) == 0
        return _capsule(self)

    def __dlpack_device__(self):
        return (2, 0)

    def __len__(self):
        return self.shape[0]

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)  # no protocol but those above
        found = getattr(self.get(), name)
        return _on_host(found) if callable(found) else found


def _here(value):
    return value.get() if isinstance(value, ndarray) else value


def _on_host(function):
    @functools.wraps(function)
    def call(*arguments, **named):
        result = function(*map(_here, arguments), **{name: _here(v) for name, v in named.items()})
        return asarray(result) if isinstance(result, (np.ndarray, np.generic)) else result

    return call


for _name in "add sub mul neg invert eq ge gt le lt getitem int float bool".split():
    setattr(ndarray, f"__{_name}__", _on_host(getattr(np.ndarray, f"__{_name}__")))


def __getattr__(name):
    return _on_host(getattr(np, name))


def asnumpy(array):
    return array.get()


def asarray(array):
    """A view of what is on the device, else a copy there."""
    if isinstance(array, ndarray):
        return array
    interface = getattr(array, "__cuda_array_interface__", None)
    if interface is not None:
        shape, dtype = interface["shape"], np.dtype(interface["typestr"])
        assert interface["strides"] is None and interface["stream"] is None
        strides = np.empty(shape, dtype).strides
        return ndarray(shape, dtype, strides, interface["data"][0], array)
    host = np.asarray(array)
    packed = host if host.flags.c_contiguous or host.flags.f_contiguous else np.ascontiguousarray(host)
    memory = _Memory(packed.nbytes)
    assert emulated.upload(memory.address, packed.ctypes.data, packed.nbytes, cuda.Stream.current) == 0
    return ndarray(packed.shape, packed.dtype, packed.strides, memory.address, memory)


def asfortranarray(array):
    return asarray(np.asfortranarray(_here(array)))


# ------------------------------------------------------------------------------------- DLPack


class _Tensor(ctypes.Structure):  # DLManagedTensor, version 0
    _fields_ = [
        ("data", ctypes.c_void_p),
        ("device_type", ctypes.c_int32),
        ("device", ctypes.c_int32),
        ("ndim", ctypes.c_int32),
        ("code", ctypes.c_uint8),
        ("bits", ctypes.c_uint8),
        ("lanes", ctypes.c_uint16),
        ("shape", ctypes.POINTER(ctypes.c_int64)),
        ("strides", ctypes.POINTER(ctypes.c_int64)),
        ("offset", ctypes.c_uint64),
        ("context", ctypes.c_void_p),
        ("deleter", ctypes.CFUNCTYPE(None, ctypes.c_void_p)),
    ]


_CODES = {"i": 0, "u": 1, "f": 2, "b": 6}
_api = ctypes.pythonapi
_api.PyCapsule_New.restype = ctypes.py_object
_api.PyCapsule_New.argtypes = [ctypes.c_void_p, ctypes.c_char_p, ctypes.c_void_p]
_api.PyCapsule_GetPointer.restype = ctypes.c_void_p
_api.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
_api.PyCapsule_SetName.argtypes = [ctypes.py_object, ctypes.c_char_p]
_lent = {}  # address of a tensor: it, and what it needs


@ctypes.CFUNCTYPE(None, ctypes.c_void_p)
def _returned(tensor):
    del _lent[tensor]


def _capsule(array):
    n = len(array.shape)
    shape = (ctypes.c_int64 * n)(*array.shape)
    strides = (ctypes.c_int64 * n)(*(step // array.dtype.itemsize for step in array.strides))
    code, bits = _CODES[array.dtype.kind], 8 * array.dtype.itemsize
    tensor = _Tensor(array.address, 2, 0, n, code, bits, 1, shape, strides, 0, None, _returned)
    _lent[ctypes.addressof(tensor)] = tensor, array
    return _api.PyCapsule_New(ctypes.addressof(tensor), b"dltensor", None)


def from_dlpack(array):
    capsule = array.__dlpack__(stream=cuda.Stream.current or 1)
    tensor = _Tensor.from_address(_api.PyCapsule_GetPointer(capsule, b"dltensor"))
    assert tensor.device_type == 2 and tensor.offset == 0
    shape = tensor.shape[: tensor.ndim]
    kind = next(kind for kind, code in _CODES.items() if code == tensor.code)
    dtype = np.dtype(f"{kind}{tensor.bits // 8}")
    strides = np.empty(shape, dtype).strides
    return ndarray(shape, dtype, strides, tensor.data, (capsule, array))
