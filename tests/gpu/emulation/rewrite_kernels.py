#!/usr/bin/env python3
"""Turns the text of kernels into C++ for the host, to run on the emulated device.

    rewrite_kernels.py ROOT FILE TO [--host]

Only what no macro can say is changed: launches and their bounds, shared memory, inline assembly and
the macros that tell a device's compiler. The errors of planted_errors.py are written into the text
as well, each behind a switch.
"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from planted_errors import with_switches

DEVICE_HEAD = '#define CULLHULL_EMULATED_DEVICE 1\n#include "device_text.hpp"\n'


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
        call = f"[=](const auto&... arguments) {{ {name}(arguments...); }}"
        launch = f'emulation::launch("{name}", {function}, {call}, {text[at + 3 : end]})'
        text = text[:begin] + launch + text[end + 3 :]
    return text


STATIC_SHARED = re.compile(
    r"__shared__ (?:alignas\([^;]*?\)\) )?((?:typename )?\w[\w:]*(?: char)?) (\w+)(?:\[([^\]]*)\])?;"
)


def static_shared(found: re.Match[str]) -> str:
    """A variable in a block's shared memory as the block's piece of the emulation's."""
    kind, name, count = found.groups()
    bytes_of = f"sizeof({kind})" + (f" * ({count})" if count else "")
    memory = f"::emulation::static_shared_memory({bytes_of}, EMULATION_HERE)"
    if count:
        return f"auto* const {name} = static_cast<{kind}*>({memory});"
    return f"auto& {name} = *static_cast<{kind}*>({memory});"


def closing(text: str, at: int) -> int:
    """The place after the parenthesis that closes the one at ``at``."""
    depth = 0
    while True:
        depth += {"(": 1, ")": -1}.get(text[at], 0)
        at += 1
        if depth == 0:
            return at


def with_launch_bounds(text: str) -> str:
    """``__launch_bounds__(N, ...)`` as a call of the emulation in the kernel's body."""
    while (at := text.find("__launch_bounds__(")) >= 0:
        opening = text.index("(", at)
        end = closing(text, opening)
        most = text[opening + 1 : end - 1]
        depth = [most[:i].count("(") - most[:i].count(")") for i in range(len(most))]
        comma = next((i for i, c in enumerate(most) if c == "," and depth[i] == 0), len(most))
        parameters = text.index("(", end)
        name = text[end:parameters].strip()
        body = text.index("{", closing(text, parameters)) + 1
        check = f' ::emulation::require_threads({most[:comma]}, "{name}");'
        text = text[:at] + text[end:body] + check + text[body:]
    return text


def rewritten(text: str) -> str:
    text = with_launches(with_launch_bounds(text))
    text = text.replace("__CUDA_ARCH__", "CULLHULL_EMULATED_DEVICE")
    text = text.replace("__CUDACC__", "CULLHULL_EMULATED_DEVICE")
    text = re.sub(
        r"extern __shared__ (\w+) (\w+)\[\];",
        r"\1* \2 = static_cast<\1*>(emulation::dynamic_shared_memory());",
        text,
    )
    text = re.sub(STATIC_SHARED, static_shared, text)
    if "__shared__" in text:
        sys.exit("rewrite_kernels: a declaration of shared memory that is not understood")
    return re.sub(
        r'asm\("rcp\.approx\.ftz\.f32 .*\);',
        "r = emulation::approximate_reciprocal(v);",
        text,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("root", type=Path)
    parser.add_argument("file", help="its name from the root on")
    parser.add_argument("target", type=Path)
    parser.add_argument("--host", action="store_true", help="host code: nothing but the errors")
    arguments = parser.parse_args()
    text = with_switches((arguments.root / arguments.file).read_text(), arguments.file)
    head = '#include "planted.hpp"\n' if arguments.host else DEVICE_HEAD
    arguments.target.parent.mkdir(parents=True, exist_ok=True)
    arguments.target.write_text(
        head
        + f'#line 1 "{Path(arguments.file).name}"\n'
        + (text if arguments.host else rewritten(text))
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
