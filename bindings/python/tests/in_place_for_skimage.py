"""A pytest plugin that puts our class in the place of SciPy's for scikit-image's own tests.

scikit-image catches SciPy's error for flat input and shows its text, so the class is strict.
"""

from __future__ import annotations

import skimage.morphology.convex_hull as module

import cullhull

made = []


def convex_hull(*arguments, **options):
    made.append(1)
    return cullhull.ConvexHull(*arguments, strict=True, **options)


def pytest_runtest_setup(item):
    module.ConvexHull = convex_hull


def pytest_sessionfinish(session, exitstatus):
    print(f"\n{len(made)} hulls by cullhull")
