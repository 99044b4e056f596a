"""What arrays are taken, that they are read in place, and what is refused how."""

import gc
import mmap
import sys

import numpy as np
import pytest

import cullhull
from programs import python

CUBE = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])


def in_place(array):
    from cullhull._arguments import as_points

    return np.shares_memory(as_points(array), array)


@pytest.mark.parametrize("dtype", ["?", "i1", "u1", "i2", "u2", "i4", "u4", "f4", "f8"])
def test_types_read_in_place(dtype):
    points = CUBE.astype(dtype)
    assert in_place(points)
    hull = cullhull.convex_hull(points)
    assert hull.volume == 1 and hull.facet_count == 6 and len(hull.vertices) == 8


@pytest.mark.parametrize("dtype", ["i8", "u8", ">f8", ">i4", "f2", "longdouble"])
def test_types_converted_exactly(dtype):
    assert cullhull.convex_hull(CUBE.astype(dtype)).volume == 1


def test_values_no_double_holds_are_refused():
    big = CUBE.astype(np.int64) * 2**60
    assert cullhull.convex_hull(big).volume == 2.0**180
    big[3, 1] += 1
    with pytest.raises(ValueError, match="no double holds"):
        cullhull.convex_hull(big)
    unsigned = CUBE.astype(np.uint64) * (2**64 - 1)
    with pytest.raises(ValueError, match="no double holds"):
        cullhull.convex_hull(unsigned)
    if np.finfo(np.longdouble).nmant > 52:
        with pytest.raises(ValueError, match="no double holds"):
            cullhull.convex_hull(CUBE + np.longdouble(2) ** -60)


def layouts():
    """Names and arrays of the same points, differently laid out."""
    base = cullhull.generate("ball", 5000, 3)
    wide = np.zeros((5000, 7))
    wide[:, 1:7:2] = base
    record = np.zeros(5000, dtype=np.dtype([("tag", "u1"), ("xyz", "f8", 3)]))
    record["xyz"] = base
    read_only = base.copy()
    read_only.flags.writeable = False
    yield "c", base
    yield "fortran", np.asfortranarray(base)
    yield "columns", wide[:, 1:7:2]
    yield "reversed", base[::-1].copy()[::-1]
    yield "reversed columns", base[:, ::-1].copy()[:, ::-1]
    yield "every second", np.repeat(base, 2, axis=0)[::2]
    yield "packed records", record["xyz"]
    yield "read only", read_only
    yield "transposed", np.ascontiguousarray(base.T).T


@pytest.mark.parametrize("points", [pytest.param(points, id=name) for name, points in layouts()])
def test_layouts(points):
    assert in_place(points)
    expected = cullhull.convex_hull(cullhull.generate("ball", 5000, 3))
    hull = cullhull.convex_hull(points)
    assert np.array_equal(hull.simplices, expected.simplices)
    assert hull.volume == expected.volume
    assert hull.contains(points).all()


def test_broadcast_and_subclass():
    assert cullhull.convex_hull(np.broadcast_to(np.float32(2), (100, 3))).affine_dimension == 0

    class Special(np.ndarray):
        pass

    special = CUBE.astype(float).view(Special)
    assert cullhull.convex_hull(special).volume == 1 and in_place(special)


def test_memory_map(tmp_path):
    points = cullhull.generate("ball", 20_000, 3)
    np.save(tmp_path / "points.npy", points)
    mapped = np.load(tmp_path / "points.npy", mmap_mode="r")
    assert in_place(mapped)
    assert cullhull.convex_hull(mapped).volume == cullhull.convex_hull(points).volume


class Dlpack:
    """An array that speaks DLPack alone."""

    def __init__(self, array, device=(1, 0)):
        self.array, self.device = array, device

    def __dlpack__(self, **arguments):
        return self.array.__dlpack__(**arguments)

    def __dlpack_device__(self):
        return self.device


def test_dlpack():
    assert cullhull.convex_hull(Dlpack(CUBE.astype(np.float32))).volume == 1


class NoDlpack(Dlpack):
    """Refuses as a tensor of PyTorch does that requires a gradient, or is of no type of NumPy's."""

    dtype = "bfloat16"

    def __init__(self, error, device=(1, 0)):
        super().__init__(error, device)

    def __dlpack__(self, **arguments):
        raise self.array


def test_what_dlpack_refuses_is_one_line():
    hull = cullhull.convex_hull(CUBE)
    for call in (cullhull.convex_hull, cullhull.convex_hulls, hull.contains, cullhull.delaunay):
        with pytest.raises(cullhull.InvalidArgument, match="`points.*: use tensor.detach"):
            call(NoDlpack(BufferError("use tensor.detach()")))
        with pytest.raises(TypeError, match="`points.* of type bfloat16 is not readable by NumPy"):
            call(NoDlpack(RuntimeError("Unsupported dtype in DLTensor.")))


def test_sets_in_any_array_of_three_axes():
    sets = np.random.default_rng(1).random((5, 20, 3))
    volumes = cullhull.convex_hulls(sets).volumes

    class Interface:
        __array_interface__ = sets.__array_interface__

    for array in (Dlpack(sets), Interface()):
        assert np.array_equal(cullhull.convex_hulls(array).volumes, volumes)
    with pytest.raises(cullhull.InvalidArgument, match="3D array; its number of dimensions is 2"):
        cullhull.convex_hulls(Dlpack(CUBE.astype(float)))


def test_hulls_that_live_until_the_end_are_no_leaks():
    keep = (
        "import ctypes, cullhull\n"
        "hull = cullhull.convex_hull([[0, 0], [1, 0], [0, 1]])\n"
        "ctypes.pythonapi.Py_IncRef(ctypes.py_object(hull))\n"
    )
    done = python("-c", keep, timeout=100)
    assert (done.returncode, done.stderr) == (0, "")


class Device:
    """Says that it is in a device's memory."""

    def __init__(self, **changes):
        self.__cuda_array_interface__ = {
            "shape": (8, 3),
            "typestr": "<f4",
            "data": (1 << 20, True),
            "version": 3,
            **changes,
        }


ASKED = cullhull.convex_hull(CUBE)


@pytest.mark.skipif(cullhull.cuda_status()["available"], reason="there is a device")
def test_everything_that_reads_device_arrays_says_that_there_is_none():
    sets = Device(shape=(2, 4, 3))
    for call in (
        lambda: cullhull.convex_hulls(Device(), [0, 4, 8]),
        lambda: cullhull.convex_hulls(sets),
        lambda: cullhull.convex_hulls_on_device(Device(), [0, 4, 8]),
        lambda: cullhull.convex_hulls_on_device(sets),
        lambda: cullhull.convex_hull_on_device(Device()),
        lambda: cullhull.HullTracker().update(Device()),
        lambda: ASKED.contains(Device()),
        lambda: ASKED.sides(Device(stream=1)),
        lambda: ASKED.distance(Device()),
        lambda: ASKED.support(Device(stream=1)),
        lambda: ASKED.contains(Device(), on_device=True),
        lambda: ASKED.sides(Device(), on_device=True),
        lambda: ASKED.distance(Device(), on_device=True),
        lambda: ASKED.support(Device(), on_device=True, backend="cpu"),
    ):
        with pytest.raises(cullhull.BackendUnavailable):
            call()
    with pytest.raises(TypeError, match="device's memory"):
        cullhull.convex_hulls_on_device(CUBE, [0, 8])
    with pytest.raises(TypeError, match="device's memory"):
        cullhull.convex_hull_on_device(CUBE)
    for question in (ASKED.contains, ASKED.sides, ASKED.distance, ASKED.support):
        with pytest.raises(TypeError, match="`on_device` needs .* device's memory"):
            question(CUBE, on_device=True)
    for made in (cullhull.DeviceHull, cullhull.DeviceHullBatch, cullhull.DeviceArray):
        with pytest.raises(TypeError, match="convex_hulls?_on_device"):
            made()


@pytest.mark.skipif(cullhull.cuda_status()["available"], reason="there is a device")
def test_device_arrays_without_a_device():
    assert cullhull.cuda_status()["reason"]
    strided = Device(strides=(-16, 4), stream=1, typestr="<f4")
    empty = Device(shape=(0, 3), data=(0, True))
    for points in (Device(), strided, empty, Dlpack(CUBE.astype(np.float32), device=(2, 0))):
        for function in (cullhull.convex_hull, cullhull.cull, cullhull.ConvexHull):
            with pytest.raises(cullhull.BackendUnavailable):
                function(points)
    with pytest.raises(cullhull.BackendUnavailable):
        cullhull.convex_hull(CUBE, backend="cuda")


@pytest.mark.parametrize("question", ["contains", "sides", "distance", "support"])
def test_questions_about_points_of_the_host_have_the_cpu(question):
    ask = getattr(ASKED, question)
    assert np.array_equal(ask(CUBE, backend="cpu"), ask(CUBE))
    with pytest.raises(cullhull.InvalidArgument, match="asked about on the CPU"):
        ask(CUBE, backend="cuda")
    with pytest.raises(cullhull.InvalidArgument, match="unknown backend"):
        ask(CUBE, backend="gpu")


def test_device_arrays_that_are_refused():
    for changes, error in (
        ({"shape": (8,)}, ValueError),
        ({"shape": (2, 2, 2)}, ValueError),
        ({"typestr": "<i4"}, TypeError),
        ({"typestr": ">f4"}, TypeError),
        ({"typestr": 4}, TypeError),
        ({"mask": object()}, ValueError),
        ({"shape": 8}, TypeError),
        ({"shape": (8.0, 3)}, TypeError),
        ({"shape": (-8, 3)}, ValueError),
        ({"shape": (8, 2**40)}, ValueError),
        ({"strides": (12,)}, ValueError),
        ({"strides": [12, 4]}, TypeError),
        ({"strides": (13, 4)}, ValueError),
        ({"data": 1 << 20}, TypeError),
        ({"data": ("here", True)}, TypeError),
        ({"data": (0, True)}, ValueError),
        ({"data": (None, True)}, ValueError),
        ({"data": (-4096, True)}, ValueError),
        ({"data": ((1 << 20) + 1, True)}, ValueError),
        ({"stream": "default"}, TypeError),
        ({"stream": -1}, ValueError),
    ):
        for function in (cullhull.convex_hull, cullhull.cull):
            with pytest.raises(error) as caught:
                function(Device(**changes))
            assert not isinstance(caught.value, cullhull.BackendUnavailable)
    for missing in ("shape", "typestr", "data"):
        points = Device()
        del points.__cuda_array_interface__[missing]
        with pytest.raises(ValueError, match=missing):
            cullhull.convex_hull(points)
    points = Device()
    points.__cuda_array_interface__ = ["shape"]
    with pytest.raises(TypeError, match="dict"):
        cullhull.convex_hull(points)
    with pytest.raises(ValueError, match="certify"):
        cullhull.convex_hull(Device(stream=1), certify=True)


class FakeCore:
    """In the place of the extension: what it is asked to wait for, in order."""

    class DevicePoints:
        data, sets = 1 << 20, -1

        @staticmethod
        def from_interface(*fields):
            return fields

        @classmethod
        def from_dlpack(cls, capsule, owner, stream=None):
            view = cls()
            view.stream = stream
            return view

    class DeviceStream:
        def __init__(self, device):
            self.device, self.handle = device, 4096 + device

    def __init__(self):
        self.waited = []

    def cuda_status(self):
        return {"available": True}

    def wait_for_cuda_stream(self, stream):
        self.waited.append(("stream", stream))

    def wait_for_cuda_device_of(self, memory):
        self.waited.append(("device", memory))


@pytest.fixture
def fake_core(monkeypatch):
    from cullhull import _device

    core = FakeCore()
    monkeypatch.setattr(_device, "_core", core)
    return core


@pytest.mark.parametrize(
    ("changes", "stream", "waited"),
    [
        ({}, 1, [("device", 1 << 20)]),  # PyTorch's: it does not say
        ({"stream": None}, 1, [("device", 1 << 20)]),
        ({"stream": 1}, 1, []),
        ({"stream": 2}, 1, [("stream", 2)]),  # the calling thread's own
        ({"stream": 1234}, 1234, []),
    ],
)
def test_points_are_read_behind_the_work_that_makes_them(fake_core, changes, stream, waited):
    from cullhull._device import as_device_points

    view = as_device_points(Device(**changes))
    assert view[6] == stream and fake_core.waited == waited


def test_dlpack_is_told_the_stream_that_reads(fake_core):
    from cullhull._device import as_device_points

    class Maker(Dlpack):
        asked = ()

        def __dlpack__(self, **arguments):
            self.asked = arguments
            return "capsule"

    maker = Maker(CUBE, device=(2, 3))
    view = as_device_points(maker)
    assert maker.asked == {"stream": view.stream.handle} and view.stream.device == 3
    assert fake_core.waited == []

    class OldMaker(Dlpack):
        def __dlpack__(self):
            return "capsule"

    assert as_device_points(OldMaker(CUBE, device=(2, 0))).stream is None
    assert fake_core.waited == [("device", 1 << 20)]


def test_a_tensor_on_a_device_that_requires_a_gradient_is_refused(fake_core):
    from cullhull._device import as_device_points

    class Tensor(Dlpack):
        @property
        def __cuda_array_interface__(self):
            raise RuntimeError("use var.detach()")

    for points in (Tensor(CUBE, (2, 0)), NoDlpack(BufferError("use var.detach()"), (2, 0))):
        with pytest.raises(cullhull.InvalidArgument, match="`points`: use var.detach"):
            as_device_points(points)


def test_dlpack_comes_before_an_interface_that_names_no_stream(fake_core):
    from cullhull._device import as_device_points

    class Both(Device):
        asked = None

        def __dlpack_device__(self):
            return (2, 0)

        def __dlpack__(self, **arguments):
            self.asked = arguments
            return "capsule"

    for changes in ({}, {"stream": None}):
        maker = Both(**changes)
        assert isinstance(as_device_points(maker), FakeCore.DevicePoints)
        assert maker.asked == {"stream": 4096} and fake_core.waited == []
    named = Both(stream=1234)
    assert as_device_points(named)[6] == 1234 and named.asked is None


def test_sets_of_points_on_a_device_are_one_view(fake_core):
    from cullhull._device import as_device_offsets, as_device_points, set_shape

    sets = Device(shape=(5, 4, 3))
    view = as_device_points(sets, sets=True)
    assert view[1:5] == (20, 3, 12, 4) and set_shape(sets, view) == (5, 4)
    strided = Device(shape=(5, 4, 3), strides=(96, 24, 8))
    assert as_device_points(strided, sets=True)[3:5] == (24, 8)
    plain = Device()
    assert set_shape(plain, as_device_points(plain, sets=True)) is None
    for changes in ({"strides": (100, 24, 8)}, {"strides": (24, 8)}):
        with pytest.raises(ValueError):
            as_device_points(Device(shape=(5, 4, 3), **changes), sets=True)
    with pytest.raises(ValueError):
        as_device_points(sets)

    fake_core.waited.clear()
    offsets = Device(shape=(6,), typestr="<i8")
    assert as_device_offsets(offsets) == (1 << 20, 6)
    assert fake_core.waited == [("device", 1 << 20)] and as_device_offsets([0, 8]) is None
    for changes, error in (
        ({"shape": (6,), "typestr": "<i4"}, TypeError),
        ({"shape": (6,), "typestr": "<i8", "strides": (16,)}, TypeError),
        ({"shape": (0,), "typestr": "<i8"}, ValueError),
        ({"shape": (6, 1), "typestr": "<i8"}, ValueError),
    ):
        with pytest.raises(error):
            as_device_offsets(Device(**changes))


def test_arrays_on_a_device_describe_themselves():
    class Items:
        data, shape, typestr, device = 4096, [7, 3], "<i4", 1

        def dlpack(self):
            return "capsule"

    array = cullhull.DeviceArray._of(Items())
    assert array.__cuda_array_interface__ == {
        "shape": (7, 3),
        "typestr": "<i4",
        "data": (4096, False),
        "strides": None,
        "stream": None,
        "version": 3,
    }
    assert (len(array), array.dtype, array.device) == (7, "int32", 1)
    assert array.__dlpack_device__() == (2, 1) and "CUDA device 1" in repr(array)
    assert array.__dlpack__(stream=7, max_version=(1, 0), dl_device=(2, 1)) == "capsule"
    for refused in ({"dl_device": (1, 0)}, {"copy": True}):
        with pytest.raises(BufferError):
            array.__dlpack__(**refused)
    for typestr in ("|b1", "|i1", "<i4", "<i8", "<f8"):
        Items.typestr = typestr
        assert np.dtype(array.dtype) == np.dtype(typestr)


def test_a_dlpack_capsule_is_viewed_and_its_memory_kept():
    array = np.arange(12.0).reshape(4, 3)
    before = sys.getrefcount(array)
    view = cullhull._core.DevicePoints.from_dlpack(array.__dlpack__(), "maker")
    assert (view.data, view.dimension, view.sets) == (array.ctypes.data, 3, -1)
    assert sys.getrefcount(array) > before
    del view
    gc.collect()
    assert sys.getrefcount(array) == before
    view = cullhull._core.DevicePoints.from_dlpack(array.reshape(2, 2, 3).__dlpack__(), "maker")
    assert (view.dimension, view.sets, view.set_size) == (3, 2, 2)


def batch_left_there(cupy, points, offsets, expected):
    """Planes, measures and padded rows of balls, whose facets are simplices."""

    def here(array):
        return cupy.asnumpy(cupy.asarray(array))

    left = cullhull.convex_hulls_on_device(points, offsets, planes=True, measures=True)
    for name in ("volumes", "areas", "centroids", "affine_dimensions"):
        assert np.array_equal(here(getattr(left, name)), getattr(expected, name)), name
    assert np.array_equal(here(left.vertex_offsets), expected.vertices.offsets)
    assert np.array_equal(3 * here(left.simplex_offsets), expected.simplices.offsets)
    assert np.array_equal(here(left.planes), expected.facet_planes)
    with pytest.raises(AttributeError, match="not padded"):
        _ = left.vertex_counts
    most = int(np.diff(expected.vertices.offsets).max())
    for padded in (True, (most, 2 * most), (most + 1, 2 * most + 5)):
        rows = cullhull.convex_hulls_on_device(points, offsets, padded=padded, planes=True)
        vertices, simplices, planes = map(here, (rows.vertices, rows.simplices, rows.planes))
        width = most if padded is True else padded[0]
        assert vertices.shape == (len(expected), width) and vertices.dtype == np.int32
        assert simplices.shape[2] == 3 and planes.shape == (*simplices.shape[:2], 4)
        there = np.arange(width) < here(rows.vertex_counts)[:, None]
        assert np.array_equal(vertices[there], expected.vertices.items)
        assert (vertices[~there] == -1).all()
        there = np.arange(simplices.shape[1]) < here(rows.simplex_counts)[:, None]
        assert np.array_equal(simplices[there].ravel(), expected.simplices.items)
        assert np.array_equal(planes[there], expected.facet_planes)
        assert (simplices[~there] == -1).all() and not planes[~there].any()
        for name in ("vertex_offsets", "volumes"):
            with pytest.raises(AttributeError):
                getattr(rows, name)
    with pytest.raises(cullhull.InvalidArgument, match=r"set \d+ has \d+ vertices"):
        cullhull.convex_hulls_on_device(points, offsets, padded=(most - 1, 2 * most))


@pytest.mark.skipif(not cullhull.cuda_status()["available"], reason="needs a CUDA device")
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_hulls_left_on_a_device(dtype):
    """Found there, and by the CPU: of a sphere, a polygon, a line in space, a cube, no points."""
    cupy = pytest.importorskip("cupy")
    line = np.outer(np.arange(5), [1, 2, 3])
    for points in (
        cullhull.generate("sphere", 20_000, 3), cullhull.generate("disk", 500, 2), line, CUBE, line[:0]
    ):  # fmt: skip
        points = np.asarray(points).astype(dtype)
        expected = cullhull.convex_hull(points)
        left = cullhull.convex_hull_on_device(cupy.asarray(points), backend="cuda")
        arrays = left.vertices, left.simplices, left.simplex_neighbours, left.planes
        for name in ("dimension", "affine_dimension", "point_count", "volume", "area"):
            assert getattr(left, name) == getattr(expected, name), name
        assert np.array_equal(left.centroid, expected.centroid)
        assert left.statistics["cull_reason"].endswith("the hull") == (len(points) == 20_000)
        assert repr(left).endswith(f"{len(expected.simplices)} simplices>")
        del left  # the arrays keep the memory
        planes = expected.facet_planes[expected.simplex_facets]
        members = expected.vertices, expected.simplices, expected.simplex_neighbours, planes
        for there, here in zip(arrays, members):
            assert there.shape == here.shape and there.dtype == str(here.dtype)
            if here.size:
                for array in (cupy.asarray(there), cupy.from_dlpack(there)):
                    assert np.array_equal(cupy.asnumpy(array), here)


@pytest.mark.skipif(not cullhull.cuda_status()["available"], reason="needs a CUDA device")
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_batches_and_questions_on_a_device(dtype):
    cupy = pytest.importorskip("cupy")
    points = cullhull.generate("ball", 50_000, 3).astype(dtype).reshape(1000, 50, 3)
    there = cupy.asarray(points)
    expected = cullhull.convex_hulls(points)
    flat, offsets = there.reshape(-1, 3), cupy.arange(1001) * 50
    for batch in (cullhull.convex_hulls(there), cullhull.convex_hulls(flat, offsets)):
        assert np.array_equal(batch.volumes, expected.volumes)
        assert np.array_equal(batch.vertex_points, expected.vertex_points)
        assert np.array_equal(batch.facet_planes, expected.facet_planes)
    batch_left_there(cupy, flat, offsets, expected)
    left = cullhull.convex_hulls_on_device(flat, offsets)
    vertices = cupy.asarray(left.vertices)
    assert np.array_equal(cupy.asnumpy(vertices), expected.vertices.items)
    assert np.array_equal(cupy.asnumpy(cupy.from_dlpack(left.vertices)), expected.vertices.items)
    assert np.array_equal(cupy.asnumpy(cupy.asarray(left.simplices)).ravel(), expected.simplices.items)
    del left  # the arrays keep the memory
    assert np.array_equal(cupy.asnumpy(vertices), expected.vertices.items)
    hull = cullhull.convex_hull(points[0])
    for name in ("contains", "sides", "distance", "support"):
        answers = getattr(hull, name)(points.reshape(-1, 3))
        assert np.array_equal(getattr(hull, name)(flat), answers)
        for backend in ("auto", "cpu", "cuda"):
            there_too = getattr(hull, name)(flat, on_device=True, backend=backend)
            for array in (cupy.asarray(there_too), cupy.from_dlpack(there_too)):
                assert np.array_equal(cupy.asnumpy(array), answers)
                assert array.dtype == answers.dtype
    tracker, there_too = cullhull.HullTracker(), cullhull.HullTracker()
    for _ in range(3):
        a, b = tracker.update(points.reshape(-1, 3)), there_too.update(flat)
        assert np.array_equal(a.simplices, b.simplices)
        assert np.array_equal(a.vertex_points, b.vertex_points)


@pytest.mark.skipif(not cullhull.cuda_status()["available"], reason="needs a CUDA device")
def test_device_arrays_of_side_streams():
    torch = pytest.importorskip("torch")
    points = cullhull.generate("ball", 3_000_000, 3).astype(np.float32)
    expected = cullhull.convex_hull(points).vertices
    host = torch.from_numpy(points).pin_memory()
    for _ in range(20):
        there = torch.zeros(points.shape, dtype=torch.float32, device="cuda")
        torch.cuda.synchronize()
        with torch.cuda.stream(torch.cuda.Stream()):
            there.copy_(host, non_blocking=True)
            assert np.array_equal(cullhull.convex_hull(there).vertices, expected)


@pytest.mark.skipif(not cullhull.cuda_status()["available"], reason="needs a CUDA device")
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_device_arrays(dtype):
    cupy = pytest.importorskip("cupy")
    points = cullhull.generate("ball", 300_000, 3).astype(dtype)
    expected = cullhull.convex_hull(points)
    there = cupy.asarray(points)
    for array in (there, cupy.asfortranarray(there), Dlpack(there, device=(2, 0))):
        hull = cullhull.convex_hull(array)
        assert np.array_equal(hull.simplices, expected.simplices)
        assert np.array_equal(hull.vertex_points, expected.vertex_points)
        assert hull.volume == expected.volume and hull.statistics["backend"] == "cuda"
        assert np.isin(expected.vertices, cullhull.cull(array)).all()


@pytest.mark.parametrize(
    "bad, error",
    [
        (CUBE.astype(object), TypeError),
        (CUBE.astype(complex), TypeError),
        (np.array([["a", "b"], ["c", "d"]]), TypeError),
        (np.zeros((3, 2), dtype="M8[s]"), TypeError),
        (np.zeros(4, dtype=[("x", "f8"), ("y", "f8")]).reshape(2, 2), TypeError),
        ([[None, 1], [2, 3]], TypeError),
        ({"a": 1}, ValueError),
        (None, ValueError),
        ("points", ValueError),
        (np.zeros(5), ValueError),
        (np.zeros((2, 2, 2)), ValueError),
        (np.float64(3), ValueError),
        ([[1, 2], [3]], ValueError),
        (np.zeros((5, 0)), ValueError),
        (np.ma.masked_all((4, 2)), ValueError),
    ],
)
def test_what_is_refused(bad, error):
    for function in (cullhull.convex_hull, cullhull.cull, cullhull.ConvexHull):
        with pytest.raises(error):
            function(bad)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_not_finite(value, dtype):
    points = cullhull.generate("ball", 10_000, 3).astype(dtype)
    points[4321, 1] = value
    for function in (cullhull.convex_hull, cullhull.cull, cullhull.ConvexHull):
        with pytest.raises(cullhull.NotFinite, match="4321") as caught:
            function(points)
        assert isinstance(caught.value, ValueError)
    hull = cullhull.convex_hull(CUBE)
    for question in (hull.contains, hull.distance, hull.support, hull.visible_from):
        with pytest.raises(ValueError):
            question([0.0, value, 0.0])


def test_zero_rows():
    empty = np.empty((0, 3))
    assert cullhull.convex_hull(empty).affine_dimension == -1
    assert len(cullhull.cull(empty)) == 0
    hull = cullhull.convex_hull(CUBE)
    assert hull.contains(empty).shape == (0,) and hull.support(empty).shape == (0,)
    assert hull.rays(empty, [1.0, 0, 0]).hit.shape == (0,)
    with pytest.raises(ValueError, match="No points"):
        cullhull.ConvexHull(empty)


def test_questions_of_another_dimension():
    hull = cullhull.convex_hull(CUBE)
    for question in (hull.contains, hull.sides, hull.distance, hull.support, hull.visible_from):
        with pytest.raises(ValueError, match="dimension 3"):
            question([0.0, 1.0])
    with pytest.raises(ValueError, match="one point"):
        hull.visible_from([[0.0, 1.0, 2.0], [0.0, 0.0, 0.0]])
    with pytest.raises(ValueError, match="as many"):
        hull.rays(np.zeros((2, 3)), np.ones((3, 3)))


def test_buffer_cannot_be_freed_during_a_call():
    memory = bytearray(cullhull.generate("ball", 30_000, 3).tobytes())
    points = np.frombuffer(memory, dtype=np.float64).reshape(-1, 3)
    attempts = []

    def free(phase, share):
        try:
            memory.clear()
        except BufferError as error:
            attempts.append(error)

    expected = cullhull.convex_hull(points.copy()).volume
    assert cullhull.convex_hull(points, progress=free).volume == expected
    assert attempts
    mapping = mmap.mmap(-1, len(memory))
    mapping[:] = bytes(memory)
    mapped = np.frombuffer(mapping, dtype=np.float64).reshape(-1, 3)
    with pytest.raises(BufferError):
        mapping.close()
    assert cullhull.convex_hull(mapped).volume == expected


def test_buffers_are_released():
    memory = bytearray(CUBE.astype(np.float64).tobytes())
    points = np.frombuffer(memory, dtype=np.float64).reshape(-1, 3)
    hull = cullhull.convex_hull(points)
    hull.contains(points)
    with pytest.raises(ValueError):
        cullhull.convex_hull(points[0:0, 0:0])
    with pytest.raises(BufferError):
        memory.clear()
    del points
    gc.collect()
    memory.clear()
    assert hull.volume == 1


@pytest.mark.parametrize("wrong", [None, object(), {"x": 1}, cullhull.delaunay([[0, 0], [1, 1]])])
def test_what_is_no_array_is_named(wrong):
    said = f"`points` should be a 2D array, not of type {type(wrong).__name__}$"
    for take in (cullhull.convex_hull, cullhull.Delaunay, cullhull.NearestNDInterpolator):
        with pytest.raises(cullhull.InvalidArgument, match=said):
            take(wrong, [1]) if take is cullhull.NearestNDInterpolator else take(wrong)


MASKED = np.ma.masked_array(np.arange(12.0).reshape(6, 2) ** 2)
MASKED[0, 0] = np.ma.masked
PLAIN = np.array(MASKED.data)
TAKING_ARRAYS = {
    "points of griddata": lambda m: cullhull.griddata(m, PLAIN[:, 0], PLAIN),
    "a column of griddata": lambda m: cullhull.griddata(tuple(m.T), PLAIN[:, 0], PLAIN),
    "values of griddata": lambda m: cullhull.griddata(PLAIN, m[:, 0], PLAIN),
    "xi of griddata": lambda m: cullhull.griddata(PLAIN, PLAIN[:, 0], m),
    "points of griddata in 1D": lambda m: cullhull.griddata(m[:, 0], PLAIN[:, 0], PLAIN[:, 0]),
    "xi of griddata in 1D": lambda m: cullhull.griddata(PLAIN[:, 0], PLAIN[:, 0], m[:, 0]),
    "values of NearestNDInterpolator": lambda m: cullhull.NearestNDInterpolator(PLAIN, m),
    "xi of NearestNDInterpolator": lambda m: cullhull.NearestNDInterpolator(PLAIN, PLAIN)(m),
    "xi of find_simplex": lambda m: cullhull.Delaunay(PLAIN).find_simplex(m),
    "xi of tsearch": lambda m: cullhull.tsearch(cullhull.Delaunay(PLAIN), m),
    "keys of hulls_by": lambda m: cullhull.hulls_by(PLAIN, m[:, 0]),
    "edges": lambda m: cullhull.constrained_delaunay(PLAIN, m[:2].astype(int)),
    "offsets": lambda m: cullhull.convex_hulls(PLAIN, m[:1, 0].astype(int)),
}


@pytest.mark.parametrize("what", TAKING_ARRAYS)
def test_no_mask_is_dropped(what):
    with pytest.raises(cullhull.InvalidArgument, match="cannot be a masked array"):
        TAKING_ARRAYS[what](MASKED)


def test_griddata_takes_what_everything_takes():
    points = np.random.default_rng(4).random((20, 2))
    values, asked = points[:, 0].copy(), points.mean(axis=0)[np.newaxis]
    expected = cullhull.griddata(points, values, asked)
    for method in ("linear", "nearest", "natural", "cubic"):
        plain = cullhull.griddata(points, values, asked, method)
        assert cullhull.griddata(*map(Dlpack, (points, values, asked)), method) == plain
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame(points, columns=["x", "y"]).astype("Float64")
    assert cullhull.griddata(frame, frame["x"], frame[:1]).shape == (1,)
    assert cullhull.griddata(frame, values, asked) == expected
