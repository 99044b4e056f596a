"""MPI's communicators, and the recipes for other engines; each where its packages are."""

import os
import pathlib
import shutil
import subprocess
import sys
import textwrap

import pytest

EXAMPLES = pathlib.Path(__file__).parents[3] / "examples" / "clusters"


def run(words, timeout=300, env=None):
    return subprocess.run(words, capture_output=True, text=True, timeout=timeout, env=env)


def python(script, *words):
    return [sys.executable, *words, str(script)]


def mpirun(ranks):
    if shutil.which("mpirun") is None:
        pytest.skip("mpirun is not installed")
    pytest.importorskip("mpi4py")
    return ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", str(ranks)]


@pytest.mark.parametrize(
    ("example", "needs"),
    [
        ("dask_hull.py", ["dask.array"]),
        ("duckdb_hull.py", ["duckdb", "pyarrow"]),
        ("ray_hull.py", ["ray"]),
        ("spark_hull.py", ["pyspark", "pandas", "pyarrow"]),
    ],
)
def test_recipes(example, needs):
    for package in needs:
        pytest.importorskip(package)
    if "pyspark" in needs and shutil.which("java") is None:
        pytest.skip("Spark needs Java")
    # Without a token, which Ray would keep in the user's folder.
    done = run(python(EXAMPLES / example), env={**os.environ, "RAY_AUTH_MODE": "disabled"})
    assert done.returncode == 0, done.stderr
    assert "vertices" in done.stdout


def test_mpi_recipe():
    done = run(mpirun(4) + python(EXAMPLES / "mpi_hull.py"))
    assert done.returncode == 0, done.stderr
    assert "4 ranks, 200,000 points" in done.stdout


#: Random sets, cut over the ranks with empty shares; every rank draws the same ones.
AGREE = """
    import random, sys
    import numpy as np
    from mpi4py import MPI
    import cullhull, cullhull.mpi
    sys.path.insert(0, {tests!r})
    from test_dask import random_points
    from test_stream import same

    world = MPI.COMM_WORLD
    choice = random.Random(5)
    for _ in range({runs}):
        points = random_points(choice)
        cuts = sorted(choice.randint(0, len(points)) for _ in range(world.size - 1))
        mine = np.split(points, cuts)[world.rank]
        root = choice.choice([None, choice.randrange(world.size)])
        hull = cullhull.mpi.convex_hull(world, mine, root=root)
        assert (hull is None) == (root is not None and root != world.rank)
        if hull is not None:
            assert same(hull, cullhull.convex_hull(points))
        ids = cullhull.mpi.extreme_points(world, mine)
        if world.rank == 0:
            assert ids.tolist() == sorted(cullhull.convex_hull(points).vertices.tolist())
"""

#: Every rank has the same error, which names the rank at fault.
FAIL = """
    from mpi4py import MPI
    import numpy as np
    import cullhull, cullhull.mpi

    world = MPI.COMM_WORLD
    points = cullhull.generate("sphere", 5000, 3, seed=world.rank + 1)
    spoilt = points.copy()
    spoilt[17, 2] = np.nan
    flat = points[:, :2] if world.rank == 2 else points
    budget = 50_000 if world.rank == 1 else None
    for error, words, given, options in (
        (cullhull.NotFinite, "rank 2", spoilt if world.rank == 2 else points, {{}}),
        (cullhull.InvalidArgument, "rank 2", flat, {{}}),
        (cullhull.OutOfBudget, "rank 1", points, {{"memory_budget": budget}}),
        (cullhull.InvalidArgument, "rank 0", object() if world.rank == 0 else points, {{}}),
    ):
        try:
            cullhull.mpi.convex_hull(world, given, **options)
        except error as told:
            assert words in str(told), told
        else:
            raise AssertionError(error)
    print("told", flush=True)
"""


@pytest.mark.parametrize("ranks", [1, 3, 5])
def test_ranks_give_one_process_bits(ranks, tmp_path):
    pytest.importorskip("dask")  # for the sets
    script = tmp_path / "agree.py"
    tests = str(pathlib.Path(__file__).parent)
    script.write_text(textwrap.dedent(AGREE).format(tests=tests, runs=30))
    done = run(mpirun(ranks) + python(script, "-m", "mpi4py"))
    assert done.returncode == 0, done.stderr


def test_errors_reach_every_rank(tmp_path):
    script = tmp_path / "fail.py"
    script.write_text(textwrap.dedent(FAIL).format())
    done = run(mpirun(4) + python(script, "-m", "mpi4py"), timeout=120)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("told") == 4
