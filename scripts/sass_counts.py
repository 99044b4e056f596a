#!/usr/bin/env python3
"""Counts what our kernels are made of: instructions by class, registers, memory of threads and blocks.

    scripts/sass_counts.py OBJECT... [--write bench/notes/gpu.md | --check FILE] [--json FILE]
                           [--fetch FOLDER]

OBJECT: objects or cubins with machine code of our kernels, of any architectures. What is counted
comes from NVIDIA's cuobjdump: $CUOBJDUMP, on PATH, beside nvcc, or, with --fetch, from PyPI into
FOLDER. --write puts the tables between the page's markers; --check compares what it finds with
them, architecture by architecture, and wants no kernel to use memory of its threads' own.

Exit status: 0; 1 a kernel spills, or the page says something else; 77 nothing to count with, or the
page's compiler is another.
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
BEGIN, END = "<!-- sass_counts.py: begin -->", "<!-- sass_counts.py: end -->"
TOOLS = ("nvidia-cuda-cuobjdump>=13,<14", "nvidia-cuda-nvdisasm>=13,<14")
REFERENCE = 90  # the architecture whose kernels are told one by one
DIMENSIONS = (2, 3, 4, 5, 6)

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


def family(name: str) -> tuple[str, int]:
    """The name without its dimension, and that; 0 where it has none."""
    for pattern in (r"(PackedRows|AnyStrides|RowsInPlace|MoveFacet|AxisExtremes)<(\d)",):
        if m := re.search(pattern, name):
            d = int(m[2])
            general = re.sub(rf"<{d}([,>])", r"<d\1", name)
            return re.sub(r"(CopyRows<.*), \d+>", r"\1, 2d>", general), d
    if m := re.match(
        r"(set_hulls|measure_hulls|write_planes|pack_lists|hull_sides|hull_cell_sides|hull_distances"
        r"|hull_supports)<(\d), (.*)>$",
        name,
    ):
        return f"{m[1]}<{m[3]}>", int(m[2])
    return name, 0


def worded(name: str) -> str:
    """A family's name in words."""
    if m := re.match(r"mask_kernel<(\w+), (\w+)<d, (\w+)>, (\w+)>", name):
        rows = "packed" if m[2] == "PackedRows" else "any strides"
        points = {"float": "f32", "double": "f64"}
        frame = "" if m[3] == m[4] else ", frame in f64"
        place = "" if m[1] == "true" else ", table beyond shared memory"
        return f"mask: {points[m[3]]} {rows}{frame}{place}"
    if m := re.match(r"(for_each|scatter_max|reduce)<(.*)>$", name):
        bodies = re.findall(r"\b([A-Z]\w+)<", m[2]) or [m[2]]
        body = next((b for b in bodies if b not in ("RowsInPlace", "AxisExtremes")), bodies[0])
        kind = re.search(r"RowsInPlace<d, (\w+)>", m[2])
        body = {"EmitKept": f"EmitKept, {re.search(r'(MovePoint|EmitId|$)', m[2])[0]}"}.get(body, body)
        return f"{m[1]}: {body}" + (f", {'f64' if kind[1] == 'double' else 'f32'}" if kind else "")
    if m := re.fullmatch(r"pack_lists<(float|double), (.*)>", name):
        ids = "bytes and rows" if "char" in m[2] else "integers"
        return f"pack_lists: {ids}, {'f32' if m[1] == 'float' else 'f64'}"
    if m := re.fullmatch(r"scatter_kernel<(.*)>", name):
        return f"scatter_kernel, {'bytes' if 'char' in m[1] else 'words'}"
    if name == "item_runs<int>":
        return "item_runs, integers"
    if m := re.fullmatch(r"(\w+)<(float|double)>", name):
        return f"{m[1]}, {'f32' if m[2] == 'float' else 'f64'}"
    return name


def row(cells: list[object]) -> str:
    return "| " + " | ".join(str(c) for c in cells) + " |"


def summary(kernels: list[Kernel]) -> str:
    """A line an architecture."""
    lines = [
        row(["", "kernels", "instructions", "most registers", "bytes of a thread's stack",
             "loads and stores of it", "most shared memory, bytes"]),
        row(["---"] + ["---:"] * 6),
    ]
    for a in sorted({k.architecture for k in kernels}):
        of = [k for k in kernels if k.architecture == a]
        lines.append(
            row([f"sm_{a}", len(of), sum(k.instructions for k in of),
                 max(k.registers for k in of), sum(k.stack for k in of),
                 sum(k.classes.get("local memory", 0) for k in of), max(k.shared for k in of)])
        )
    return "\n".join(lines)


def families(kernels: list[Kernel]) -> str:
    """Instructions and registers of each kernel, dimensions side by side."""
    lines = [row(["instructions / registers", *(f"{d}D" for d in DIMENSIONS)]),
             row(["---"] + ["---:"] * len(DIMENSIONS))]
    table: dict[str, dict[int, str]] = collections.defaultdict(dict)
    for k in sorted(kernels, key=lambda k: k.instructions):  # of namesakes the longest
        name, d = family(k.name)
        table[worded(name)][d] = f"{k.instructions} / {k.registers}"
    for name in sorted(table):
        cells = table[name]
        lines.append(row([name, *(cells.get(d, cells.get(0, "") if d == 2 else "") for d in DIMENSIONS)]))
    return "\n".join(lines)


def by_class(kernels: list[Kernel]) -> str:
    """What the kernels for three dimensions and single precision consist of."""
    wanted = [k for k in kernels if family(k.name)[1] in (0, 3)]
    names = [n for n in (*CLASSES, "integers, selections") if n != "local memory"]
    lines = [row(["", *names]), row(["---"] + ["---:"] * len(names))]
    for k in sorted(wanted, key=lambda k: worded(family(k.name)[0])):
        name = worded(family(k.name)[0])
        if "f64" in name or "beyond" in name or name.startswith("CUB"):
            continue
        lines.append(row([name, *(k.classes.get(n, 0) for n in names)]))
    return "\n".join(lines)


def sections(kernels: list[Kernel]) -> dict[str, str]:
    """The tables by name; what is told one by one is that of the reference architecture."""
    made = {f"sm_{a}": summary([k for k in kernels if k.architecture == a]).splitlines()[-1]
            for a in sorted({k.architecture for k in kernels})}
    reference = [k for k in kernels if k.architecture == REFERENCE]
    if reference:
        made["families"], made["classes"] = families(reference), by_class(reference)
    return made


def page(kernels: list[Kernel], compiler: str) -> str:
    made = sections(kernels)
    head = "\n".join(summary(kernels).splitlines()[:2])
    rows = "\n".join(made[f"sm_{a}"] for a in sorted({k.architecture for k in kernels}))
    return (
        f"{BEGIN}\nCounted in the machine code of nvcc {compiler} by `scripts/sass_counts.py`.\n\n"
        f"{head}\n{rows}\n\nsm_{REFERENCE}:\n\n{made['families']}\n\n"
        f"sm_{REFERENCE}, 3D, single precision, instructions by class:\n\n{made['classes']}\n{END}"
    )


def compiler_version() -> str:
    for nvcc in (os.environ.get("CUDACXX"), "nvcc", "/usr/local/cuda/bin/nvcc"):
        if nvcc and shutil.which(nvcc):
            text = subprocess.run([nvcc, "--version"], capture_output=True, text=True).stdout
            if m := re.search(r"V(\d+\.\d+\.\d+)", text):
                return m[1]
    return "?"


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


def check(kernels: list[Kernel], text: str, compiler: str) -> int:
    status = 0
    for k in kernels:
        if not k.keeps_to_registers:
            print(f"sm_{k.architecture}: {k.name} has {k.stack} bytes of stack and "
                  f"{k.classes.get('local memory', 0)} accesses to memory of its threads' own")
            status = 1
    told = text[text.index(BEGIN) : text.index(END)]
    if f"nvcc {compiler} " not in told:
        print(f"the page's figures are of another compiler than nvcc {compiler}")
        return status or SKIPPED
    for name, table in sections(kernels).items():
        if table not in told:
            print(f"the page tells something else of {name} than:\n{table}")
            status = 1
    return status


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("objects", nargs="+", type=Path)
    parser.add_argument("--write", type=Path)
    parser.add_argument("--check", type=Path)
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
    compiler = compiler_version()
    if arguments.json:
        arguments.json.write_text(json.dumps([asdict(k) for k in kernels], indent=1) + "\n")
    if arguments.check:
        return check(kernels, arguments.check.read_text(), compiler)
    if arguments.write:
        text = arguments.write.read_text()
        before, rest = text.split(BEGIN)
        arguments.write.write_text(before + page(kernels, compiler) + rest.split(END)[1])
    else:
        print(page(kernels, compiler))
    return 0 if all(k.keeps_to_registers for k in kernels) else 1


if __name__ == "__main__":
    sys.exit(main())
