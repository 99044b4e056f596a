#!/usr/bin/env python3
"""Counts what our kernels are made of: instructions by class, registers, memory of threads and blocks.

    scripts/sass_counts.py OBJECT... [--json FILE] [--fetch FOLDER]

OBJECT: objects or cubins with machine code of our kernels, of any architectures. What is counted
comes from NVIDIA's cuobjdump: $CUOBJDUMP, on PATH, beside nvcc, or, with --fetch, from PyPI into
FOLDER. Prints a table with a row a kernel.

Exit status: 0; 1 a kernel has a stack frame or spills; 77 nothing to count with.
"""

from __future__ import annotations

import argparse
import collections
import json
import os
import re
import shutil
import subprocess
import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path

SKIPPED = 77
TOOLS = ("nvidia-cuda-cuobjdump>=13,<14", "nvidia-cuda-nvdisasm>=13,<14")

CLASSES = {  # the first that fits
    "local memory": r"(LDL|STL)",
    "f64": r"D(ADD|MUL|FMA|SETP|MNMX)",
    "f32": r"F(ADD|MUL|FFMA|FMA|SETP|SET|MNMX|SEL|CHK)\d*|FFMA",
    "conversions, roots": r"(MUFU|F2F|F2I|I2F|FRND|F2FP|I2FP|POPC|FLO|BREV)",
    "global memory": r"(LDG|STG|LD|ST|ATOM|ATOMG|RED|REDG|CCTL|ERRBAR|MEMBAR)",
    "shared memory": r"(LDS|STS|ATOMS|LDSM)",
    "constants": r"U?(LDC|LDCU|S2R|S2UR|CS2R|R2UR)|ULDC|S2R",
    "lanes": r"(SHFL|VOTE|VOTEU|MATCH|REDUX|ELECT|R2P|P2R)",
    "control": r"(BRA|BRX|JMP|EXIT|BAR|BSSY|BSYNC|WARPSYNC|NANOSLEEP|RET|CALL|BREAK|NOP|DEPBAR|YIELD"
    r"|BMOV|KILL|ACQBULK|PREEXIT)",
}


@dataclass
class Kernel:
    name: str
    architecture: int
    registers: int = 0
    stack: int = 0
    shared: int = 0
    instructions: int = 0
    classes: dict[str, int] = field(default_factory=collections.Counter)

    @property
    def keeps_to_registers(self) -> bool:
        return self.stack == 0 and self.classes.get("local memory", 0) == 0


def class_of(opcode: str) -> str:
    for name, pattern in CLASSES.items():
        if re.fullmatch(pattern, opcode):
            return name
    return "integers, selections"


def readable(symbols: list[str]) -> list[str]:
    """Names without namespaces and parameters, as short as one can tell them apart by."""
    plain = subprocess.run(
        ["c++filt"], input="\n".join(symbols), capture_output=True, text=True, check=True
    ).stdout.splitlines()
    return [short(name) for name in plain]


def short(name: str) -> str:
    name = re.sub(r"^void ", "", name)
    name = name.replace("(anonymous namespace)::", "")
    name = re.sub(r"cullhull::(?:[a-z_]+::)*", "", name)
    depth, end = 0, len(name)
    for i, c in enumerate(name):  # the parameter list, which no bracket encloses
        depth += {"<": 1, ">": -1}.get(c, 0)
        if c == "(" and depth == 0:
            end = i
            break
    name = re.sub(r"(\d)u\b", r"\1", name[:end])
    if name.startswith("cub::"):
        return "CUB " + re.search(r"(\w+?)(Kernel)?(<|$)", name.split("::")[-1] or name)[1] if (
            "<" not in name
        ) else "CUB " + re.search(r"::(\w+?)(Kernel)?<", name)[1]
    return name


def dumped(tool: str, flag: str, files: list[Path]) -> str:
    return "\n".join(
        subprocess.run([tool, flag, str(f)], capture_output=True, text=True, check=True).stdout
        for f in files
    )


def kernels_of(tool: str, files: list[Path]) -> list[Kernel]:
    found: dict[tuple[int, str], Kernel] = {}

    def kernel(architecture: int, symbol: str) -> Kernel:
        return found.setdefault((architecture, symbol), Kernel(symbol, architecture))

    for file in files:
        architecture, now = 0, None
        for line in dumped(tool, "-sass", [file]).splitlines():
            if m := re.match(r"\s*code for sm_(\d+)", line):
                architecture, now = int(m[1]), None
            elif m := re.match(r"\s*Function : (\S+)", line):
                now = kernel(architecture, m[1])
            elif now and (
                m := re.match(r"\s+/\*[0-9a-f]{4,}\*/\s+(?:@!?U?P\w+\s+)?([A-Z][A-Z0-9_]*)", line)
            ):
                if m[1] == "NOP":
                    continue  # fills the last line of code
                now.instructions += 1
                now.classes[class_of(m[1])] += 1
        symbol, architectures = "", sorted({a for a, _ in found})
        # Resources are told in the same order, an architecture after another.
        seen: collections.Counter[str] = collections.Counter()
        for line in dumped(tool, "-res-usage", [file]).splitlines():
            if m := re.match(r"\s*Function (\S+):$", line.rstrip()):
                symbol = m[1]
            elif symbol and (m := re.search(r"REG:(\d+) STACK:(\d+) SHARED:(\d+)", line)):
                own = [a for a in architectures if (a, symbol) in found]
                k = found[own[seen[symbol] % len(own)], symbol]
                seen[symbol] += 1
                k.registers, k.stack, k.shared = map(int, m.groups())
                symbol = ""
    kernels = list(found.values())
    for k, name in zip(kernels, readable([k.name for k in kernels]), strict=True):
        k.name, k.classes = name, dict(k.classes)
    return sorted(kernels, key=lambda k: (k.architecture, k.name))


def table(kernels: list[Kernel]) -> str:
    """A line a kernel, the longest first."""
    classes = [n for n in (*CLASSES, "integers, selections") if n != "local memory"]
    head = ["", "sm", "instructions", "registers", "shared memory, bytes", *classes]
    rows = [[k.name, k.architecture, k.instructions, k.registers, k.shared,
             *(k.classes.get(n, 0) for n in classes)]
            for k in sorted(kernels, key=lambda k: (k.architecture, -k.instructions, k.name))]
    return "\n".join("| " + " | ".join(map(str, r)) + " |" for r in [head, ["---"] * len(head), *rows])


def find_tool(fetch: Path | None) -> str | None:
    for candidate in (os.environ.get("CUOBJDUMP"), "cuobjdump", "/usr/local/cuda/bin/cuobjdump"):
        if candidate and (found := shutil.which(candidate)):
            return found
    if fetch is None:
        return None
    tool = fetch / "nvidia/cu13/bin/cuobjdump"
    if not tool.exists():
        subprocess.run(
            [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check",
             "--no-deps", "--target", str(fetch), *TOOLS],
            check=False,
        )
    if not tool.exists():
        return None
    os.environ["PATH"] += os.pathsep + str(tool.parent)  # it asks nvdisasm
    return str(tool)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("objects", nargs="+", type=Path)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--fetch", type=Path)
    arguments = parser.parse_args()
    tool = find_tool(arguments.fetch)
    if tool is None or shutil.which("c++filt") is None:
        print("sass_counts: cuobjdump and c++filt are needed")
        return SKIPPED
    kernels = kernels_of(tool, arguments.objects)
    if not kernels:
        sys.exit("sass_counts: no machine code in these files")
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(k) for k in kernels], indent=1) + "\n")
    print(table(kernels))
    spilling = [k for k in kernels if not k.keeps_to_registers]
    for k in spilling:
        print(f"sm_{k.architecture}: {k.name} has {k.stack} bytes of stack and "
              f"{k.classes.get('local memory', 0)} accesses to memory of its threads' own")
    return 1 if spilling else 0


if __name__ == "__main__":
    sys.exit(main())
