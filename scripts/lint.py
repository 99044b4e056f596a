#!/usr/bin/env python3
"""Holds the sources to .clang-format and .clang-tidy.

Usage: scripts/lint.py format|tidy BUILD
format: every C++ and CUDA source of the tree. tidy: what the build folder compiles of src, apps,
viewer and bindings; sources that are compiled together are checked together. Exit status: 0;
1 findings, which are printed; 77 no such tool of the version that counts (others find other things).
"""

import concurrent.futures
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

VERSION = "14"
ROOT = Path(__file__).resolve().parent.parent
FOLDERS = ["src", "apps", "viewer", "bindings"]


def tool_named(name):
    for candidate in (f"{name}-{VERSION}", name):
        if tool := shutil.which(candidate):
            told = subprocess.run([tool, "--version"], capture_output=True, text=True).stdout
            if re.search(rf"version {VERSION}\.", told):
                return tool
    print(f"lint: no {name} {VERSION}")
    sys.exit(77)


def format_findings():
    sources = [str(f) for kind in ("cpp", "hpp", "cu", "cuh", "c", "h") for f in ROOT.rglob(f"*.{kind}")
               if f.relative_to(ROOT).parts[0] != "build"]
    ran = subprocess.run([tool_named("clang-format"), "--dry-run", *sources], capture_output=True,
                         text=True)
    return len(sources), [line for line in ran.stderr.splitlines() if "warning: " in line]


def is_ours(entry):
    """Whether this command compiles a file of FOLDERS: itself, or what a unity source includes."""
    path = Path(entry["file"])
    files = [path]
    if path.name.startswith("unity_"):
        files = re.findall(r'#include "(.*)"', path.read_text())
    return any(Path(f).is_relative_to(ROOT / name) for f in files for name in FOLDERS)


def tidy_findings(build):
    tool = tool_named("clang-tidy")
    commands = []
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if entry["file"].endswith((".cpp", ".cxx")) and is_ours(entry):
            # clang reads no precompiled header of another compiler, nor knows all its warnings.
            entry["command"] = re.sub(r" (-include \S+cmake_pch\S*|-W\S+|-fpch-preprocess)", "",
                                      entry["command"])
            commands.append(entry)
    with tempfile.TemporaryDirectory() as scratch, concurrent.futures.ThreadPoolExecutor(
        os.cpu_count()
    ) as threads:
        Path(scratch, "compile_commands.json").write_text(json.dumps(commands))
        ran = threads.map(
            lambda file: subprocess.run(
                [tool, "-p", scratch, "--quiet", f"--config-file={ROOT / '.clang-tidy'}", file],
                capture_output=True, text=True,
            ),
            sorted({entry["file"] for entry in commands}),
        )
        found = {line: None for r in ran for line in r.stdout.splitlines()
                 if re.search(r": (warning|error): ", line)}
    return len(commands), list(found)


def main():
    what, build = sys.argv[1], Path(sys.argv[2])
    count, found = format_findings() if what == "format" else tidy_findings(build)
    print(*found, sep="\n")
    print(f"lint: {count} sources, {len(found)} findings")
    return 1 if found or count == 0 else 0


sys.exit(main())
