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
PRIMITIVES = ("emulated_kernel_tests", "PrimitivesGpu.*")
SETS = (
    "emulated_tests",
    "GpuSets.AnyStrides*:GpuSets.Ordinary*:GpuSets.SetsThat*:GpuSets.Spheres*",
)
MEASURES = ("emulated_tests", "GpuSets.PlanesAndMeasures*")
PADDED = ("emulated_tests", "GpuSets.Padded*")
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
        "swapped-words": Planted(
            "two words of a mask exchanged",
            "«words[k] = word;»",
            "words[k ^ 1] = word;",
            *LAYOUTS,
        ),
        "one-shuffle-less": Planted(
            "one shuffle too few where lanes' bits become words",
            "«apart < lanes_a_word»; apart *= 2",
            "apart * 2 < lanes_a_word",
            *LAYOUTS,
        ),
        "short-tile": Planted(
            "the last word of a mask is not read",
            "«first + k < words» ? mask",
            "first + k + 1 < words",
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
        "narrow-mask-word": Planted(
            "the index of a mask's word in 32 bits where words are written",
            "lane, mask + «group * words»);",
            "static_cast<std::uint32_t>(group * words)",
            *WIDE,
        ),
        "narrow-tile-word": Planted(
            "the index of a mask's word in 32 bits where words are read",
            "first = «std::uint64_t{blockIdx.x} * tile_words + threadIdx.x * thread_words»;\n"
            "  for (unsigned k = 0; k < thread_words; ++k) mine",
            "static_cast<std::uint32_t>(blockIdx.x * tile_words + threadIdx.x * thread_words)",
            *WIDE,
        ),
        "narrow-id": Planted(
            "ids of points computed in 32 bits",
            "*out++ = «(first + k) * 32 + static_cast<std::uint32_t>(__ffs(static_cast<int>(word)) - 1)»;",
            "static_cast<std::uint32_t>((first + k) * 32 +"
            " static_cast<std::uint32_t>(__ffs(static_cast<int>(word)) - 1))",
            *WIDE,
        ),
        "plain-first": Planted(
            "atomicMin made plain where the first point that is not finite is found",
            "«atomicMin(first, static_cast<unsigned long long>(i));»",
            "if (i < *first) *first = i;",
            "emulated_tests",
            "CudaGauge.TheFirstPoint*",
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
            "the host does not wait for a piece's mask",
            '«synchronise(stream_.get(), "culling");»',
            "",
            "emulated_tests",
            "CudaGauge.ManyPieces",
        ),
        "other-stream": Planted(
            "rows gathered on another stream",
            "gather_rows(part, piece_ids_.data(), n, packed_.data(), «stream»)",
            "nullptr",
            "emulated_tests",
            "EmulatedEdges.WorkIsOrdered*",
        ),
    },
    KERNELS + "executor.cuh": {
        "no-block-barrier": Planted(
            "no barrier between two steps of a block's reduction",
            "width /= 2) {\n    «__syncthreads();»",
            "",
            *PRIMITIVES,
        ),
        "plain-count": Planted(
            "atomicAdd made plain in the count of items without a cell",
            "none != 0) «atomicAdd(none_of_all, none);»",
            "*none_of_all += none;",
            *PRIMITIVES,
        ),
        "no-wait-in-rounds": Planted(
            "no barrier between the claims of a round and its flips where one block does the rounds",
            "run_step<true>(steps, round, at);\n    «__syncthreads();»",
            "",
            *STARS,
        ),
        "no-wait-in-tiles": Planted(
            "no barrier between the list of a tile and its use",
            "kernel.find(t, at, list, shared);\n    «__syncthreads();»",
            "",
            *STARS,
        ),
        "early-tile": Planted(
            "no barrier between the use of a tile's list and the next tile",
            "kernel.use(at, list, shared);\n    «__syncthreads();»",
            "",
            *PRIMITIVES,
        ),
    },
    KERNELS + "device_kernels.hpp": {
        "plain-raise": Planted(
            "atomicMax made plain in `DeviceAtomics::raise`",
            "«atomicMax(reinterpret_cast<unsigned long long*>(&target), value);»",
            "target = value;",
            *PRIMITIVES,
        ),
        "plain-lower": Planted(
            "atomicMin made plain in `DeviceAtomics::lower`",
            "«atomicMin(&target, value);»",
            "target = value;",
            *PRIMITIVES,
        ),
        "listed-twice": Planted(
            "a facet listed for a round as often as something around it changed",
            "return «atomicMax(&target, value) < value»;",
            "true",
            *STARS,
        ),
        "plain-next": Planted(
            "atomicAdd made plain in `DeviceAtomics::next`",
            "return «atomicAdd(&counter, n)»;",
            "SerialExecutor::next(counter, n)",
            *STARS,
        ),
    },
    KERNELS + "warp_hull.cuh": {
        "plain-mark": Planted(
            "atomicOr made plain in `WarpHull::mark`",
            "«atomicOr(m_.edges + row * (m_.most / 32) + bit / 32, 1U << bit % 32);»",
            "m_.edges[row * (m_.most / 32) + bit / 32] |= 1U << bit % 32;",
            *SETS,
        ),
        "no-wait-before-horizon": Planted(
            "no `__syncwarp` between the list of visible facets and the horizon",
            "if (seen == 0) return true;\n    «__syncwarp();»",
            "",
            *SETS,
        ),
        "no-warp-wait": Planted(
            "no `__syncwarp` between marking edges and testing them",
            "      mark(c, a);\n    }\n    «__syncwarp();»",
            "",
            *SETS,
        ),
        "early-unmark": Planted(
            "no `__syncwarp` between testing edges and clearing them",
            "c, a, edges);\n    }\n    «__syncwarp();»",
            "",
            *SETS,
        ),
        "early-facets": Planted(
            "no `__syncwarp` between new facets and the next point",
            "spares_ += seen - edges;\n    }\n    «__syncwarp();»",
            "",
            *SETS,
        ),
        "early-ranks": Planted(
            "no `__syncwarp` between points' distances and their ranks",
            "key[i] = __float_as_uint(square);\n    }\n    «__syncwarp();»",
            "",
            *SETS,
        ),
        "early-clear": Planted(
            "no `__syncwarp` in the plane between testing edges and clearing them",
            "(p << 8 | to);\n    }\n    «__syncwarp();»",
            "",
            *SETS,
        ),
        "few-slots": Planted(
            "room for 192 facets of 252",
            "facets(unsigned most) { return «D == 2 ? most : 2 * most»; }",
            "D == 2 ? most : most + most / 2",
            *SETS,
        ),
        "tied-ranks": Planted(
            "points at the same distance get the same rank",
            "key[j] == key[i] && «j < i») ? 1 : 0;",
            "false",
            *SETS,
        ),
        "loose-bound": Planted(
            "signs in f32 trusted beyond their bound",
            "return «s > doubt ? 1 : s < -doubt ? -1 : side(m_.corners[f], p)»;",
            "s > 0x1p-60F ? 1 : s < -0x1p-60F ? -1 : side(m_.corners[f], p)",
            "emulated_tests",
            "GpuSets.Ordinary*",
        ),
        "loose-doubles": Planted(
            "signs in doubles trusted beyond their bound",
            "double sum, bound = «error * extent_»;",
            "0x1p-40 * error * extent_",
            "emulated_tests",
            "GpuSets.SetsThat*",
        ),
    },
    KERNELS + "set_hulls_kernel.cu": {
        "small-warp-memory": Planted(
            "shared memory of a block 16 bytes too small",
            "shared = «warps * WarpMemory<D>::bytes(room)»;",
            "warps * WarpMemory<D>::bytes(room) - 16",
            *SIZES,
        ),
        "much-shared": Planted(
            "more shared memory than a launch may have without asking",
            "fit = static_cast<unsigned>(«block_memory / WarpMemory<D>::bytes(most)»);",
            "2 * block_memory / WarpMemory<D>::bytes(most)",
            *SIZES,
        ),
        "low-launch-bounds": Planted(
            "`__launch_bounds__(64)` on a launch of 128",
            "__launch_bounds__(«most_warps* lanes», 1)\n    set_hulls(",
            "64",
            *SIZES,
        ),
        "trusted-measures": Planted(
            "measures taken although rounding may show in them, or a normal needs more bits",
            "if («!hull.find_exponent() || !hull.measure(volume, area, centroid)») {",
            "!hull.find_exponent() || (hull.measure(volume, area, centroid), false)",
            *MEASURES,
        ),
        "other-exponent": Planted(
            "a set's planes scaled as those of the set before it",
            "hull.scale_to(«exponents[set]»);",
            "exponents[set == 0 ? 0 : set - 1]",
            *MEASURES,
        ),
    },
    KERNELS + "coordinate.cuh": {
        "one-block-less": Planted(
            "the last sets of a batch get no block",
            "blocks = «(threads + size - 1) / size»;",
            "threads < size ? 1 : threads / size",
            *SIZES,
        ),
    },
    "src/cuda/set_hulls.cpp": {
        "sets-other-stream": Planted(
            "lists packed on another stream",
            "lists.data(), rows.data(), «stream»)",
            "nullptr",
            "emulated_tests",
            "GpuSets.AnyStrides*",
        ),
        "unfilled-rows": Planted(
            "padded rows of simplices not filled up",
            "«fill(to.simplices, to.simplex_room * d(), 0xFF, stream);»",
            "",
            *PADDED,
        ),
        "shifted-centroids": Planted(
            "centroids of sets that the CPU computed written one number too far",
            "«2 * std::uint64_t{count} + i * n»",
            "2 * std::uint64_t{count} + i * n + 1",
            *MEASURES,
        ),
        "early-counts": Planted(
            "the host does not wait for the kernels that find hulls",
            '«synchronise(stream, "hulling sets");»',
            "",
            *PADDED,
        ),
        "early-lists": Planted(
            "the host does not wait for the lists of a piece",
            '«synchronise(stream, "copying hulls from the device");»',
            "",
            "emulated_tests",
            "EmulatedSets.TheNextPiece*",
        ),
    },
    KERNELS + "hull_questions_kernel.cu": {
        "no-open-side": Planted(
            "a facet whose sign is open forgotten",
            "«open = open || !(sum < -bound);»",
            "open = open && !(sum < -bound);",
            "emulated_tests",
            "GpuQuestions.PointsOnACube",
        ),
        "next-cell": Planted(
            "the cell of a direction rounded, not cut",
            "cell * resolution + «static_cast<std::uint32_t>(at)»;",
            "static_cast<std::uint32_t>(at + 0.5 < top ? at + 0.5 : top)",
            "emulated_tests",
            "GpuQuestions.ByCells*",
        ),
        "short-list": Planted(
            "only the first group of a cell's facets tested",
            "g = begin; «g < end»; ++g",
            "g == begin",
            "emulated_tests",
            "GpuQuestions.ByCells*",
        ),
        "loose-support": Planted(
            "the largest product taken although another is as near as rounding",
            "best - second > «2.01 * bound» ?",
            "0",
            "emulated_tests",
            "GpuQuestions.Directions*",
        ),
    },
    STAR_HULL + "star_growth.hpp": {
        "stale-neighbour": Planted(
            "a new facet keeps a neighbour that is replaced in the same round",
            "child.across[0] =\n        «split == no_item» ?",
            "true",
            *STARS,
        ),
        "loose-cone": Planted(
            "a point taken to be in a cone although rounding may have put it there",
            "at > f.between[k].error ? 1 : «at < -f.between[k].error» ?",
            "at < 0",
            *STARS,
        ),
    },
    STAR_HULL + "star_math.hpp": {
        "loose-edge": Planted(
            "the sign of a determinant trusted beyond its bound",
            "return «minor[7] > bound» ?",
            "minor[7] > 0",
            *STARS,
        ),
    },
    STAR_HULL + "star_flips.hpp": {
        "early-read": Planted(
            "a neighbour read before its claim is seen to be this flip's",
            "«!owns(flips.facet[f].across[k].facet(), key)» ||",
            "false",
            *STARS,
        ),
        "shared-facet": Planted(
            "a facet replaced although a stronger flip changes a side of it",
            "claim[f].own == key && «claim[f].beside < key»;",
            "true",
            *STARS,
        ),
        "sleeping-doomed": Planted(
            "sides at a doomed vertex not looked at again",
            "| doomed[f.vertex[last_corner(k)]]) != 0)\n      «waiting[side] = 1;»",
            "",
            *STARS,
        ),
        "forgotten-sides": Planted(
            "sides around a flip not looked at again",
            "for (unsigned j = 0; «j < sides»; ++j) {\n      const StarSide looks",
            "j < 1",
            *STARS,
        ),
        "kept-vertex": Planted(
            "a vertex that a flip removed not culled",
            "«culled[end] = 1;»",
            "",
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
