"""Dask's collections give the bits of one process, on every scheduler."""

import os
import random
import signal
import threading
import time

import numpy as np
import pytest

import cullhull
from test_stream import same

dask = pytest.importorskip("dask")
da = pytest.importorskip("dask.array")
import cullhull.dask as hulls  # noqa: E402

RUNS = int(os.environ.get("CULLHULL_RANDOM_RUNS", "60"))


def random_points(choice):
    """Balls, lattices with duplicates and ties, flats, few points; any scalar type."""
    d = choice.randint(1, 6)
    n = choice.choice([1, 2, 5, 40, 400, 3000 if d < 5 else 300])
    generator = np.random.default_rng(choice.randrange(1 << 30))
    kind = choice.choice(["ball", "lattice", "flat", "copies"])
    points = generator.normal(size=(n, d))
    if kind == "lattice":
        points = generator.integers(-2, 3, size=(n, d)).astype(float)
    if kind == "flat" and d > 1:
        points[:, -1] = points[:, 0]
    if kind == "copies":
        points = points[generator.integers(0, max(1, n // 3), size=n)]
    dtype = choice.choice([np.float64, np.float32, np.int16])
    return (points * 100).astype(dtype) if dtype == np.int16 else points.astype(dtype)


def random_chunks(choice, n):
    """Uneven, some empty."""
    cuts = sorted(choice.randint(0, n) for _ in range(choice.randint(0, 12)))
    return tuple(int(c) for c in np.diff([0, *cuts, n]))


def test_random_chunks_give_one_process_bits():
    choice = random.Random(20)
    for _ in range(RUNS):
        points = random_points(choice)
        n, d = points.shape
        chunks = (random_chunks(choice, n), (1,) * d if choice.random() < 0.3 else (d,))
        lazy = da.from_array(points, chunks=chunks)
        if choice.random() < 0.3:  # sizes nobody knows before
            lazy = da.concatenate(
                [
                    da.from_delayed(part, shape=(np.nan, d), dtype=points.dtype)
                    for part in lazy.rechunk({1: -1}).to_delayed().ravel()
                ],
                allow_unknown_chunksizes=True,
            )
        hull = hulls.convex_hull(lazy, split_every=choice.randint(2, 9))
        with dask.config.set(scheduler=choice.choice(["threads", "sync"])):
            assert same(hull.compute(), cullhull.convex_hull(points))
            ids = hulls.extreme_points(lazy).compute()
        assert ids.tolist() == sorted(cullhull.convex_hull(points).vertices.tolist())


def test_processes_agree():
    points = cullhull.generate("ball", 20_000, 3)
    lazy = da.from_array(points, chunks=(1500, 3))
    hull = hulls.convex_hull(lazy).compute(scheduler="processes", num_workers=2)
    assert same(hull, cullhull.convex_hull(points))


def test_cull_keeps_every_vertex_and_drops_most():
    choice = random.Random(3)
    for _ in range(RUNS // 3):
        points = random_points(choice)
        lazy = da.from_array(points, chunks=(random_chunks(choice, len(points)), (points.shape[1],)))
        ids = hulls.cull(lazy, sample=choice.choice([1, 30, 10_000])).compute()
        assert ids.dtype == np.uint64 and (np.diff(ids.astype(np.int64)) > 0).all()
        assert set(cullhull.convex_hull(points).vertices) <= set(ids.tolist())
    points = cullhull.generate("ball", 100_000, 3)
    kept = hulls.cull(da.from_array(points, chunks=(9999, 3)), sample=20_000).compute()
    assert len(kept) < 10_000


def test_frames_bags_and_lists():
    pandas = pytest.importorskip("pandas")
    frames = pytest.importorskip("dask.dataframe")
    bags = pytest.importorskip("dask.bag")
    points = cullhull.generate("ball", 3000, 3)
    whole = cullhull.convex_hull(points)
    table = pandas.DataFrame(points, columns=list("xyz")).assign(name="scan")
    frame = frames.from_pandas(table, npartitions=7)
    assert same(hulls.convex_hull(frame, columns=["x", "y", "z"]).compute(), whole)
    with pytest.raises(TypeError, match="name"):
        hulls.convex_hull(frame).compute()  # words
    pieces = [points[i : i + 100] for i in range(0, 3000, 100)]
    bag = bags.from_sequence(pieces, npartitions=4)
    assert same(hulls.convex_hull(bag).compute(scheduler="sync"), whole)
    assert same(hulls.convex_hull([dask.delayed(p) for p in pieces]).compute(), whole)


def test_errors_say_where():
    points = cullhull.generate("ball", 1000, 3)
    points[777, 1] = np.nan
    lazy = da.from_array(points, chunks=(100, 3))
    for work in (hulls.convex_hull(lazy), hulls.cull(lazy)):
        with pytest.raises(cullhull.NotFinite, match="chunk 7.*point 777"):
            work.compute(scheduler="sync")
    sphere = da.from_array(cullhull.generate("sphere", 20_000, 3), chunks=(5000, 3))
    with pytest.raises(cullhull.OutOfBudget):
        hulls.convex_hull(sphere, memory_budget=100_000).compute(scheduler="sync")
    for wrong, error in (
        (points, TypeError),
        (dask.delayed(points), TypeError),
        ([], cullhull.InvalidArgument),
        (da.zeros(5), cullhull.InvalidArgument),
    ):
        with pytest.raises(error):
            hulls.convex_hull(wrong)
    with pytest.raises(cullhull.InvalidArgument):
        hulls.convex_hull(lazy, columns=["x"])
    with pytest.raises(cullhull.InvalidArgument):
        hulls.convex_hull(lazy, split_every=1)
    with pytest.raises(cullhull.InvalidArgument, match="compute_chunk_sizes"):
        hulls.cull(lazy[lazy[:, 0] > 0])


def test_a_lost_worker_changes_nothing():
    distributed = pytest.importorskip("distributed")
    points = cullhull.generate("ball", 60_000, 3)
    whole = cullhull.convex_hull(points)
    kills = int(os.environ.get("CULLHULL_KILLS", "2"))
    choice = random.Random(9)
    with distributed.LocalCluster(
        n_workers=4, threads_per_worker=1, dashboard_address=None, processes=True
    ) as cluster, distributed.Client(cluster) as client:
        for _ in range(kills):
            lazy = da.from_array(points, chunks=(1000, 3)).map_blocks(_slowly)
            future = client.compute(hulls.convex_hull(lazy))
            time.sleep(choice.uniform(0.1, 1.0))
            pids = [pid for pid in client.run(os.getpid).values()]
            os.kill(choice.choice(pids), signal.SIGKILL)
            assert same(future.result(timeout=120), whole)


def _slowly(block):
    time.sleep(0.03)
    return block


def test_several_callers():
    points = cullhull.generate("ball", 30_000, 3)
    whole = cullhull.convex_hull(points)
    lazy = da.from_array(points, chunks=(2000, 3))
    results = []
    callers = [
        threading.Thread(target=lambda: results.append(hulls.convex_hull(lazy).compute()))
        for _ in range(4)
    ]
    for caller in callers:
        caller.start()
    for caller in callers:
        caller.join()
    assert len(results) == 4 and all(same(hull, whole) for hull in results)
