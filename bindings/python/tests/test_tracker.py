"""Moving points."""

import numpy as np
import pytest

import cullhull


def twisted(points, angle):
    turn = angle * points[:, 2]
    x = points[:, 0] * np.cos(turn) - points[:, 1] * np.sin(turn)
    y = points[:, 0] * np.sin(turn) + points[:, 1] * np.cos(turn)
    return np.column_stack([x, y, points[:, 2]])


@pytest.mark.parametrize("cull", ["auto", "gauge", "pseudo-hull", "none"])
def test_every_frame_is_the_static_hull(cull):
    points = cullhull.generate("ball", 50_000, 3)
    tracker = cullhull.HullTracker(cull=cull)
    assert tracker.hull is None
    methods = []
    for frame in range(5):
        moved = twisted(points, 0.02 * frame)
        hull, static = tracker.update(moved), cullhull.convex_hull(moved)
        assert np.array_equal(hull.simplices, static.simplices)
        assert np.array_equal(hull.facet_planes, static.facet_planes)
        assert hull.volume == static.volume and tracker.hull is hull
        assert tracker.report["index"] == frame
        methods.append(tracker.report["method"])
    assert methods[0] == "static"
    if cull == "none":
        assert set(methods) == {"static"}
    if cull in ("gauge", "pseudo-hull"):
        assert set(methods[1:]) == {cull}
    tracker.reset()
    assert tracker.hull is None
    tracker.update(points)
    assert tracker.report["index"] == 0


class Refused(Exception):
    pass


def test_errors_and_interruptions():
    points = cullhull.generate("ball", 50_000, 3)
    tracker = cullhull.HullTracker(cull="gauge")
    first = tracker.update(points)
    bad = points.copy()
    bad[77, 2] = np.nan
    with pytest.raises(cullhull.NotFinite, match="frame 1.*77"):
        tracker.update(bad)
    assert tracker.hull is first and tracker.report["index"] == 0

    def refuse(phase, share):
        raise Refused

    with pytest.raises(Refused):
        tracker.update(points, progress=refuse)
    again = tracker.update(points)
    assert np.array_equal(again.simplices, first.simplices)
    assert tracker.report["index"] == 3
    with pytest.raises(ValueError):
        cullhull.HullTracker(cull="sometimes")
