#!/usr/bin/env python3
"""Errors in the CUDA backend that the tests on the emulated device must notice.

    planted_errors.py PROGRAMS [NAME ...]       run them: PROGRAMS is the folder of the test programs
    planted_errors.py --list                    the names
    planted_errors.py PROGRAMS --write FILE     run all; write the table into FILE (bench/notes/gpu.md)
    planted_errors.py PROGRAMS --seeds N        run them with N random orders of threads each

rewrite_kernels.py writes all errors into the texts that the emulated tests are built of, each behind
a switch; a program makes the one that the environment variable CULLHULL_PLANTED names. So one build
serves all of them. A text that has changed, so that an error does not apply, ends the build.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import NamedTuple


class Planted(NamedTuple):
    what: str  # for the table
    right: str  # what is replaced, between « and », with enough around it to be found once
    wrong: str  # in its place: a statement if what is replaced ends in a semicolon
    program: str
    tests: str  # a filter of GoogleTest


KERNELS = "src/cuda/kernels/"
LAYOUTS = ("emulated_tests", "EmulatedLayouts.EveryBorder*")
WIDE = ("emulated_tests", "EmulatedLayouts.MoreThan*")
SETS = (
    "emulated_tests",
    "GpuSets.AnyStrides*:GpuSets.Ordinary*:GpuSets.SetsThat*:GpuSets.Spheres*",
)
STARS = ("emulated_tests", "StarHullGpu.Equals*:StarHullGpu.Few*")
STAR_HULL = "src/filter/star_hull/"
SIZES = ("emulated_tests", "GpuSets.AllSizes*")

#: By the file that they are in.
ERRORS = {
    KERNELS + "gauge_kernel.cu": {
        "no-barrier": Planted(
            "no barrier between copying the table to shared memory and reading it",
            "table[i] = nodes[i];\n    «__syncthreads();»",
            "",
            *LAYOUTS,
        ),
        "read-beyond": Planted(
            "a word behind a mask is read",
            "«first + k < words» ? mask",
            "first + k <= words",
            *LAYOUTS,
        ),
        "small-shared": Planted(
            "shared memory for one node too few",
            "«Shared ? table.nodes.size() * sizeof(float) : 0»",
            "Shared ? (table.nodes.size() - 1) * sizeof(float) : 0",
            *LAYOUTS,
        ),
        "narrow-id": Planted(
            "ids of points computed in 32 bits",
            "*out++ = «(first + k) * 32 + static_cast<std::uint32_t>(__ffs(static_cast<int>(word)) - 1)»;",
            "static_cast<std::uint32_t>((first + k) * 32 +"
            " static_cast<std::uint32_t>(__ffs(static_cast<int>(word)) - 1))",
            *WIDE,
        ),
    },
    "src/cuda/gauge.cpp": {
        "short-mask": Planted(
            "a mask without the room that the last warp fills",
            "mask(«mask_room(points.count)», stream);",
            "mask_words(points.count)",
            *LAYOUTS,
        ),
        "no-wait": Planted(
            "the host packs points into a buffer whose copy it has not waited for",
            '«synchronise(stream, "copying points to the device");»\n    check(cudaMemcpyAsync(rows.',
            "",
            "emulated_tests",
            "CudaGauge.ManyPieces",
        ),
        "other-stream": Planted(
            "rows gathered on another stream",
            "gather_rows(part, ids_here.get(), n, here.get(), «stream»)",
            "nullptr",
            "emulated_tests",
            "EmulatedEdges.WorkIsOrdered*",
        ),
    },
    KERNELS + "warp_hull.cuh": {
        "plain-mark": Planted(
            "atomicOr made plain in `WarpHull::mark`",
            "«atomicOr(m_.bits + i / 32, 1U << i % 32);»",
            "m_.bits[i / 32] |= 1U << i % 32;",
            *SETS,
        ),
        "no-warp-wait": Planted(
            "no `__syncwarp` between listing the facets that a point sees and reading them",
            "if (seen == 0) return true;\n    «__syncwarp();»",
            "",
            *SETS,
        ),
        "loose-bound": Planted(
            "signs in f32 trusted beyond their bound",
            "return «s > doubt ? 1 : s < -doubt ? -1 : side(m_.corners[f], p)»;",
            "s > 0x1p-60F ? 1 : s < -0x1p-60F ? -1 : side(m_.corners[f], p)",
            "emulated_tests",
            "GpuSets.Ordinary*",
        ),
    },
    KERNELS + "set_hulls_kernel.cu": {
        "low-launch-bounds": Planted(
            "`__launch_bounds__(64)` on a launch of 128",
            "__launch_bounds__(«most_warps* lanes», 1)\n    set_hulls(",
            "64",
            *SIZES,
        ),
    },
    STAR_HULL + "star_flips.hpp": {
        "early-read": Planted(
            "a neighbour read before its claim is seen to be this flip's",
            "«!owns(flips.facet[f].across[k].facet(), key)» ||",
            "false",
            *STARS,
        ),
    },
}
PLANTED = {name: error for errors in ERRORS.values() for name, error in errors.items()}


def number_of(name: str) -> int:
    """A name as the programs know it, the hash of 32 bits that planted.cpp computes (FNV-1a)."""
    value = 0x811C9DC5
    for byte in name.encode():
        value = (value ^ byte) * 0x01000193 & 0xFFFFFFFF
    return value


def with_switches(text: str, file: str) -> str:
    """The text with every error of the file behind its switch; ends the program where one does not
    apply."""
    places: dict[tuple[int, int], list[str]] = {}
    for name, error in ERRORS.get(file, {}).items():
        before, rest = error.right.split("«")
        right, after = rest.split("»")
        found = text.count(before + right + after)
        if found != 1:
            sys.exit(f"planted_errors: {name} applies to {found} places of {file}, not to one")
        begin = text.index(before + right + after) + len(before)
        places.setdefault((begin, begin + len(right)), []).append(name)
    for begin, end in sorted(places, reverse=True):
        switched = text[begin:end]
        for name in places[begin, end]:
            wrong, test = PLANTED[name].wrong, f"::emulation::planted_error == {number_of(name)}U"
            if text[begin:end].endswith(";"):
                switched = f"{{ if ({test}) {{ {wrong} }} else {{ {switched} }} }}"
            else:
                switched = f"({test} ? ({wrong}) : ({switched}))"
        text = text[:begin] + switched + text[end:]
    return text


def noticed_by(name: str, programs: Path, seed: int = 0) -> tuple[str, str] | None:
    """The test that notices an error, and what it says. A seed stands for a random order of threads,
    streams and blocks; with one seed, runs are alike."""
    error = PLANTED[name]
    run = subprocess.run(
        [programs / error.program, f"--gtest_filter={error.tests}", "--gtest_break_on_failure"],
        env={
            **os.environ,
            "CULLHULL_PLANTED": name,
            "CULLHULL_GPU_TESTS": "short",
            "CULLHULL_DEVICE_SEED": str(seed),
        },
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        errors="replace",
        check=False,
    )
    if run.returncode == 0:
        return None
    tests = re.findall(r"\[ RUN +\] (\S+)", run.stdout)
    if not tests:
        sys.exit(f"planted_errors: {error.program} did not run any test:\n{run.stdout}")
    said = re.search(r"^emulated device: (.*)$", run.stdout, re.MULTILINE)
    wrong = re.search(r": Failure$", run.stdout, re.MULTILINE)
    return tests[-1], said.group(1) if said else "a wrong result" if wrong else "a crash"


BEGIN, END = "<!-- planted_errors.py: begin -->\n", "<!-- planted_errors.py: end -->\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("programs", type=Path, nargs="?")
    parser.add_argument("names", nargs="*")
    parser.add_argument("--list", action="store_true")
    parser.add_argument("--write", type=Path)
    parser.add_argument("--seeds", type=int, default=1, metavar="N")
    arguments = parser.parse_args()
    if arguments.list:
        print("\n".join(PLANTED))
        return 0
    for name in arguments.names:
        if name not in PLANTED:
            parser.error(f"there is no planted error {name}")
    rows, unnoticed = [], []
    for name in arguments.names or PLANTED:
        for seed in range(max(1, arguments.seeds)):
            found = noticed_by(name, arguments.programs, seed)
            if found is None:
                print(f"{name}: NOT NOTICED" + f" with seed {seed}" * (seed > 0), flush=True)
                break
        if found is None:
            unnoticed.append(name)
            continue
        print(f"{name}: {found[0]}: {found[1]}", flush=True)
        rows.append(f"| {name} | {PLANTED[name].what} | `{found[0]}` |\n")
    if unnoticed:
        return 1
    if arguments.write:
        text = arguments.write.read_text()
        head, rest = text.split(BEGIN)
        table = "| planted error | what | noticed by |\n| --- | --- | --- |\n" + "".join(rows)
        arguments.write.write_text(head + BEGIN + table + END + rest.split(END)[1])
    return 0


if __name__ == "__main__":
    sys.exit(main())
