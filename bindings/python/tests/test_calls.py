"""Threads, progress, interruption: what happens around a call."""

import contextlib
import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest

import cullhull


def test_several_threads_at_once():
    sets = [cullhull.generate("ball", 20_000, 3, seed=s) for s in range(6)]
    expected = [cullhull.convex_hull(points).volume for points in sets]
    shared = cullhull.convex_hull(sets[0])
    found = [None] * 6
    inside = [None] * 6

    def work(i):
        for _ in range(5):
            found[i] = cullhull.convex_hull(sets[i]).volume
            inside[i] = shared.contains(sets[i]).sum()

    threads = [threading.Thread(target=work, args=(i,)) for i in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == expected
    assert inside[0] == 20_000 and all(0 < n <= 20_000 for n in inside)


@pytest.mark.parametrize("count", [500, 400_000])
def test_the_gil_is_released(count):
    points = cullhull.generate("sphere", count, 3)
    ticks, stop = [0], threading.Event()

    def tick():
        while not stop.is_set():
            ticks[0] += 1
            time.sleep(0)

    thread = threading.Thread(target=tick)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(60)  # so that nothing but a release lets the other thread in
    try:
        thread.start()
        before = ticks[0]
        for _ in range(1 if count > 1000 else 100):
            cullhull.convex_hull(points)
        during = ticks[0] - before
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        thread.join()
    assert during > 0


def test_progress_is_called_on_this_thread():
    calls = []
    cullhull.convex_hull(
        cullhull.generate("sphere", 200_000, 3),
        progress=lambda phase, share: calls.append((phase, share, threading.get_ident())),
        certify=True,
    )
    phases = [phase for phase, _, _ in calls]
    assert {"hull", "done", "certify"} <= set(phases)
    assert all(0 <= share <= 1 for _, share, _ in calls)
    assert {ident for _, _, ident in calls} == {threading.get_ident()}


class Refused(Exception):
    pass


def test_a_callback_that_raises_stops_the_work():
    def refuse(phase, share):
        raise Refused(phase)

    points = cullhull.generate("sphere", 50_000, 3)
    hull = cullhull.convex_hull(points[:1000])
    growing = cullhull.GrowingHull(3)
    growing.add(points[:1000])
    for call in (
        lambda: cullhull.convex_hull(points, progress=refuse),
        lambda: cullhull.convex_hull(points[:50], progress=refuse),
        lambda: cullhull.certify(points[:1000], hull, progress=refuse),
        lambda: cullhull.ConvexHull(points, progress=refuse),
        lambda: hull.distance(points, progress=refuse),
        lambda: hull.rays([0, 0, 0], points, progress=refuse),
        lambda: hull.contains(points, progress=refuse),
        lambda: growing.add(points, progress=refuse),
        lambda: cullhull.cull(points, progress=refuse),
        lambda: cullhull.convex_hulls(points.reshape(1000, 50, 3), progress=refuse),
        lambda: cullhull.HalfspaceIntersection(
            np.hstack([points, -np.ones((50_000, 1))]), [0, 0, 0], progress=refuse
        ),
    ):
        with pytest.raises(Refused):
            call()
    assert growing.hull.point_count == 1000
    with pytest.raises(TypeError):
        cullhull.convex_hull(points, progress=lambda: None)


def test_progress_true_draws_a_bar(capsys):
    pytest.importorskip("tqdm")
    cullhull.convex_hull(cullhull.generate("sphere", 50_000, 3), progress=True)
    assert "%" in capsys.readouterr().err


def test_progress_true_says_what_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "tqdm", None)
    monkeypatch.setitem(sys.modules, "tqdm.auto", None)
    with pytest.raises(ImportError, match=r"pip install 'cullhull\[progress\]'"):
        cullhull.convex_hull(np.eye(3), progress=True)


LONG = """
import signal, sys, cullhull
signal.signal(signal.SIGINT, signal.default_int_handler)  # who starts the tests may ignore it
points = cullhull.generate("sphere", 2_000_000, 3)
print("ready", flush=True)
try:
    while True:
        cullhull.convex_hull(points)
except KeyboardInterrupt:
    print("interrupted", flush=True)
print(cullhull.convex_hull(points[:1000]).affine_dimension, flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="no signals to other processes")
def test_ctrl_c_interrupts():
    child = subprocess.Popen(
        [sys.executable, "-c", LONG], stdout=subprocess.PIPE, text=True, env=os.environ
    )
    try:
        assert child.stdout.readline() == "ready\n"
        time.sleep(0.5)
        child.send_signal(signal.SIGINT)
        out, _ = child.communicate(timeout=60)
    finally:
        child.kill()
    assert out == "interrupted\n3\n" and child.returncode == 0


class Alarm(Exception):
    pass


def ring(*_):
    raise Alarm


@contextlib.contextmanager
def alarm(seconds, handler=ring, again=0):
    """The signal of a timer, for which `handler` is called."""
    if not hasattr(signal, "setitimer"):
        pytest.skip("no timer that sends a signal")
    before = signal.signal(signal.SIGALRM, handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, seconds, again)
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


@pytest.mark.parametrize("kind", ["hull", "triangulation"])
def test_unpickling_hears_a_signal(kind):
    """Its loops run signal handlers. Between the native call and extend() Python runs none."""
    from cullhull import _core

    points = cullhull.generate("sphere", 300_000, 3)
    if kind == "hull":
        make, (state, _) = _core.solid_of_state, cullhull.convex_hull(points).__reduce__()[1]
    else:
        make, (state, _) = _core.cells_of_state, cullhull.delaunay(points).__reduce__()[1]

    made = []
    with alarm(0.005), pytest.raises(Alarm):
        made.extend(map(make, [state]))
        time.sleep(10)  # should the call have ended before the signal
    assert made == []


def test_unpickling_of_cells_hears_a_signal_to_its_end():
    """At several moments: while links are compared, too, which takes most of the time."""
    from cullhull import _core

    points = np.random.default_rng(3).random((100_000, 3))
    make, (state, _) = _core.cells_of_state, cullhull.delaunay(points).__reduce__()[1]
    start = time.perf_counter()
    make(state)
    whole = time.perf_counter() - start

    heard = []
    for moment in (0.5, 0.6, 0.7, 0.8):
        made = []
        with alarm(moment * whole), pytest.raises(Alarm):
            made.extend(map(make, [state]))
            time.sleep(60)
        heard.append(made == [])
    assert any(heard)  # of a call that was quicker than the first none


def test_attributes_hear_a_signal():
    found = cullhull.Delaunay(np.random.default_rng(5).random((300_000, 3)))
    for attribute in ("equations", "transform"):
        made = []
        with alarm(0.005), pytest.raises(Alarm):
            made.extend(map(getattr, [found], [attribute]))
            time.sleep(60)
        assert made == []
        assert len(getattr(found, attribute)) == found.nsimplex


def test_points_in_the_making_hear_a_signal():
    with alarm(0.2), pytest.raises(Alarm):  # some ten seconds of work
        cullhull.generate("ball", 40_000_000, 6)
    assert cullhull.generate("ball", 3, 2).shape == (3, 2)


def test_a_signal_handler_that_raises():
    points = cullhull.generate("sphere", 1_000_000, 3)
    with alarm(0.1), pytest.raises(Alarm):
        while True:
            cullhull.convex_hull(points)


@pytest.mark.parametrize(
    "points",
    [
        pytest.param(np.linspace(-1, 1, 1500)[:, None] ** [1, 2, 3, 4], id="here"),
        pytest.param(cullhull.generate("sphere", 1_000_000, 3), id="on a thread"),
    ],
)
def test_signals_are_heard_during_a_call(points):
    """Not only after it, when all that came meanwhile are one."""
    heard = []
    with alarm(0.06, lambda number, frame: heard.append(number), again=0.06):
        cullhull.convex_hull(points, threads=1)
    assert len(heard) > 2


def test_a_handler_that_raises_stops_a_call_here():
    points = np.linspace(-1, 1, 1500)[:, None] ** [1, 2, 3, 4]
    growing = cullhull.GrowingHull(4)
    for call in (cullhull.convex_hull, cullhull.ConvexHull, growing.add):
        with alarm(0.1), pytest.raises(Alarm):
            call(points)
    assert growing.hull.point_count == 0


def _volume(seed):
    return cullhull.convex_hull(cullhull.generate("ball", 30_000, 3, seed=seed)).volume


@pytest.mark.parametrize("method", {*multiprocessing.get_all_start_methods()} - {"forkserver"})
def test_in_worker_processes(method):
    expected = [_volume(seed) for seed in (1, 2, 3)]  # the library's threads run before the fork
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map_async(_volume, (1, 2, 3)).get(timeout=120) == expected


@pytest.mark.parametrize("choice", [{"cull": "gauge-map"}, {"backend": "gpu"}, {"cull": ""}])
def test_unknown_choices_are_invalid_arguments(choice):
    (name, value) = next(iter(choice.items()))
    with pytest.raises(cullhull.InvalidArgument, match=f"unknown {name} '{value}'; expected auto"):
        cullhull.convex_hull([[0, 0], [1, 0], [0, 1]], **choice)
