"""What tests run in a process of its own."""

import os
import re
import subprocess
import sys
from pathlib import Path


def python(*words, **more):
    """This interpreter."""
    command = [sys.executable, *map(str, words)]
    return subprocess.run(command, capture_output=True, text=True, **more)


def run(*words, **more):
    """The program of the package."""
    return python("-m", "cullhull", *words, **more)


def with_path(folder):
    """The environment, with a folder more where Python looks for modules."""
    path = [str(folder), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path)}


def passed_in_place(plugin, *words, **more):
    """How many tests pass with a plugin of this folder, none failing; and what pytest prints."""
    command = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", plugin, *words)
    ran = python(*command, env=with_path(Path(__file__).parent), **more)
    print(ran.stdout[-20_000:], ran.stderr[-5_000:])
    assert ran.returncode == 0
    return int(re.search(r"(\d+) passed", ran.stdout)[1]), ran.stdout
