"""Runs other projects' own tests with our class in the place of SciPy's."""

import os
import re
from pathlib import Path

from programs import python, with_path

STAND_INS = Path(__file__).parent / "foreign"


def _run(folder, stand_ins, arguments, who):
    return python(
        *("-m", "pytest", "-q", "-p", "no:cacheprovider", "-rfE"),
        *("-c", os.devnull, "--import-mode=importlib", "--rootdir", folder, *arguments),
        cwd=folder,
        env={
            **with_path(STAND_INS / stand_ins),
            "CULLHULL_STAND_IN": who,
            # Plugins of packages that are there for other tests take longer than most of these.
            "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1",
        },
    )


def passed_and_failed(folder, stand_ins, arguments):
    """How many tests passed with ours, and the ids of those that failed with ours alone.

    stand_ins: a folder of modules that the project's source archive leaves out. What fails with
    ours runs once more with SciPy: a test that fails then too tells nothing of our class.
    """
    run = _run(folder, stand_ins, arguments, "ours")
    print(run.stdout[-20_000:], run.stderr[-2000:])
    passed = re.search(r"(\d+) passed", run.stdout)
    assert passed and run.returncode in (0, 1)
    failed = re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", run.stdout, re.M)
    if failed:
        plugins = [a for a in arguments if a.startswith("-p")]
        again = _run(folder, stand_ins, [*plugins, *failed], "scipy")
        too = set(re.findall(r"^(?:FAILED|ERROR) (.+?)(?: - .*)?$", again.stdout, re.M))
        print("fail with SciPy too, and are left out:", sorted(too))
        failed = [test for test in failed if test not in too]
    return int(passed[1]), failed
