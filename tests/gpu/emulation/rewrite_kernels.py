#!/usr/bin/env python3
"""Turns the text of kernels into C++ for the host, to run on the emulated device.

    rewrite_kernels.py FROM TO [--plant NAME] [--host]

Only what no macro can say is changed: launches, shared memory, inline assembly and the macros that
tell a device's compiler. ``--plant`` also makes one of the errors below, which the tests must notice.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

# name: (the file's end, the text, what stands in its place)
PLANTED = {
    "no-barrier": ("gauge_kernel.cu", "    __syncthreads();\n", ""),
    "swapped-words": ("gauge_kernel.cu", "words[k] = word;", "words[k ^ 1] = word;"),
    "one-shuffle-less": (
        "gauge_kernel.cu",
        "apart < lanes_a_word; apart *= 2",
        "apart * 2 < lanes_a_word; apart *= 2",
    ),
    "short-tile": ("gauge_kernel.cu", "first + k < words ? mask", "first + k + 1 < words ? mask"),
    "read-beyond": ("gauge_kernel.cu", "first + k < words ? mask", "first + k <= words ? mask"),
    "small-shared": (
        "gauge_kernel.cu",
        "Shared ? table.nodes.size() * sizeof(float) : 0",
        "Shared ? (table.nodes.size() - 1) * sizeof(float) : 0",
    ),
    "short-mask": (
        "gauge.cpp",
        "mask(mask_room(points.count), stream)",
        "mask(mask_words(points.count), stream)",
    ),
    "no-wait": (
        "gauge.cpp",
        'synchronise(stream_.get(), "culling");',
        "",
    ),
    "other-stream": (
        "gauge.cpp",
        "check(gather_rows(part, piece_ids_.data(), n, packed_.data(), stream)",
        "check(gather_rows(part, piece_ids_.data(), n, packed_.data(), nullptr)",
    ),
    "no-block-barrier": ("executor.cuh", "    __syncthreads();\n", ""),
    "no-warp-wait": (
        "warp_hull.cuh",
        "      mark(c, a);\n    }\n    __syncwarp();\n",
        "      mark(c, a);\n    }\n",
    ),
    "early-facets": (
        "warp_hull.cuh",
        "      spares_ += seen - edges;\n    }\n    __syncwarp();\n",
        "      spares_ += seen - edges;\n    }\n",
    ),
    "loose-bound": ("warp_hull.cuh", ": 0x1p-18F;", ": 0x1p-60F;"),
    "no-open-side": (
        "hull_questions_kernel.cu",
        "open = open || !(sum < -bound);",
        "open = open && !(sum < -bound);",
    ),
    "small-warp-memory": (
        "set_hulls_kernel.cu",
        "warps * WarpMemory<D>::bytes(room);",
        "warps * WarpMemory<D>::bytes(room) - 16;",
    ),
    "sets-other-stream": (
        "set_hulls.cpp",
        "simplices.data(), rows.data(), s.stream)",
        "simplices.data(), rows.data(), nullptr)",
    ),
}


def end_of_name(text: str, at: int) -> int:
    """Where the name of the kernel that is launched at ``at`` begins."""
    begin = at
    while text[begin - 1].isspace():
        begin -= 1
    if text[begin - 1] == ">":  # template arguments
        depth = 0
        while True:
            begin -= 1
            depth += {">": 1, "<": -1}.get(text[begin], 0)
            if depth == 0:
                break
    while re.match(r"[\w:]", text[begin - 1]) or (
        text[begin - 1].isspace() and text[:begin].rstrip().endswith("::")
    ):
        begin -= 1
    return begin


def with_launches(text: str) -> str:
    """``name<<<grid, block, shared, stream>>>`` as a call of the emulation."""
    while (at := text.find("<<<")) >= 0:
        end = text.index(">>>", at)
        begin = end_of_name(text, at)
        name = " ".join(text[begin:at].split()).replace(":: ", "::")
        # Attributes belong to a function; only where it is called by a variable are any set.
        function = f"reinterpret_cast<const void*>({name})" if name == "kernel" else "nullptr"
        call = f"[=](auto... arguments) {{ {name}(arguments...); }}"
        launch = f'emulation::launch("{name}", {function}, {call}, {text[at + 3 : end]})'
        text = text[:begin] + launch + text[end + 3 :]
    return text


def rewritten(text: str) -> str:
    text = with_launches(text)
    text = text.replace("__CUDA_ARCH__", "CULLHULL_EMULATED_DEVICE")
    text = text.replace("__CUDACC__", "CULLHULL_EMULATED_DEVICE")
    text = re.sub(
        r"extern __shared__ (\w+) (\w+)\[\];",
        r"\1* \2 = static_cast<\1*>(emulation::dynamic_shared_memory());",
        text,
    )
    text = text.replace("__shared__ alignas(alignof(T))", "alignas(alignof(T)) static")
    text = text.replace("__shared__", "static")  # one block runs at a time
    return re.sub(
        r'asm\("rcp\.approx\.ftz\.f32 .*\);',
        "r = emulation::approximate_reciprocal(v);",
        text,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("source", type=Path)
    parser.add_argument("target", type=Path)
    parser.add_argument("--plant", choices=PLANTED)
    parser.add_argument("--host", action="store_true", help="host code: nothing but the error")
    arguments = parser.parse_args()
    text = arguments.source.read_text()
    if arguments.plant is not None:
        file, right, wrong = PLANTED[arguments.plant]
        if str(arguments.source).endswith(file):
            if right not in text:
                sys.exit(f"rewrite_kernels: {arguments.source} has no {right!r}")
            text = text.replace(right, wrong, 1)
    arguments.target.parent.mkdir(parents=True, exist_ok=True)
    if arguments.host:
        arguments.target.write_text(text)
        return 0
    arguments.target.write_text(
        '#define CULLHULL_EMULATED_DEVICE 1\n#include "device_text.hpp"\n'
        + f'#line 1 "{arguments.source.name}"\n'
        + rewritten(text)
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
