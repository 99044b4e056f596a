"""The Python package on the emulated device: what only the emulation can count."""

import gc

import numpy as np

import cullhull
import cupy
import emulated

SETS = cullhull.generate("ball", 1000).reshape(20, 50, 3)


def test_the_device_is_the_emulated_one():
    assert cullhull.cuda_status()["device"] == "emulated device"


def test_results_on_the_device_are_freed_without_the_lock():
    """The last array of a result waits for all work of the device, which may read it still."""
    there = cupy.asarray(SETS)
    flat = there.reshape(-1, 3)
    hull = cullhull.convex_hull(SETS[0])
    results = {
        "hull": lambda: cullhull.convex_hull_on_device(flat),
        "batch": lambda: cullhull.convex_hulls_on_device(there),
        "array of a batch": lambda: cullhull.convex_hulls_on_device(there).simplices,
        "answers": lambda: hull.contains(flat, on_device=True),
        "view": lambda: cupy.from_dlpack(hull.distance(flat, on_device=True)),
    }
    for name, make in results.items():
        result = make()
        gc.collect()
        before, waited = emulated.waits_with_lock(), emulated.waits()
        del result
        gc.collect()
        assert emulated.waits() > waited, name
        assert emulated.waits_with_lock() == before, name


def test_no_call_waits_with_the_lock_held():
    points = cullhull.generate("ball", 20_000, 2).astype(np.float32)
    there = cupy.asarray(points)
    stream = cupy.cuda.Stream(non_blocking=True)
    before, waited = emulated.waits_with_lock(), emulated.waits()
    hull = cullhull.convex_hull(there, backend="cuda")
    assert hull.statistics["backend"] == "cuda"
    assert len(cullhull.cull(there, backend="cuda")) < len(points)
    solid = cupy.asarray(cullhull.generate("ball", 20_000, 3))
    assert cullhull.convex_hull(solid, backend="cuda", cull="gauge").statistics["backend"] == "cuda"
    assert cullhull.convex_hull_on_device(solid).point_count == 20_000
    with stream:
        assert cullhull.convex_hull(cupy.asarray(points), backend="cuda").volume == hull.volume
    silent = type("Silent", (), {"__cuda_array_interface__": {**there.__cuda_array_interface__}})()
    for named in (None, 2):  # no stream: all work of the device; the thread's own default stream
        silent.__cuda_array_interface__["stream"] = named
        assert cullhull.convex_hull(silent, backend="cuda").volume == hull.volume
    offsets = cupy.asarray(np.arange(0, 20_001, 50))
    cullhull.convex_hulls(there, offsets), cullhull.convex_hulls_on_device(there, offsets)
    tracker = cullhull.HullTracker()
    for _ in range(3):
        tracker.update(there)
    tracker = cullhull.HullTracker(backend="cuda")  # keeps a surface on the device
    for _ in range(3):
        assert tracker.update(solid).statistics["backend"] == "cuda"
    del tracker
    for question in (hull.contains, hull.sides, hull.distance, hull.support):
        question(there, backend="cuda"), question(there, on_device=True)
    gc.collect()
    assert emulated.waits() > waited + 20 and emulated.waits_with_lock() == before


class Dlpack:
    """Nothing but DLPack of an array."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, stream):
        return self.array.__dlpack__(stream)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


def test_dlpack_orders_streams():
    """Work on a stream is done late here: what is not waited for is seen undone."""
    points = cullhull.generate("ball", 20_000, 3).astype(np.float32)
    expected = cullhull.convex_hull(points, backend="cpu")
    stream = cupy.cuda.Stream(non_blocking=True)
    with stream:
        hull = cullhull.convex_hull_on_device(Dlpack(cupy.asarray(points)))
        assert np.array_equal(cupy.asnumpy(cupy.from_dlpack(hull.simplices)), expected.simplices)
        batch = cullhull.convex_hulls_on_device(Dlpack(cupy.asarray(SETS)))
        assert np.array_equal(
            cupy.asnumpy(cupy.from_dlpack(batch.vertices)),
            cullhull.convex_hulls(SETS).vertices.items,
        )
