#!/usr/bin/env python3
"""The binary interface against the dump that scripts/abi.sh stored, without a build for it:

    abi_test.py SOURCE COMPILER ARCHIVE [ARCHIVE ...]

- every public struct of the dump has the same size, offsets, names and enumerators in the headers,
  which the compiler is asked;
- the libraries' visible symbols are those of the dump: none is missing, new or internal;
- where libabigail and a library with debug information (build/abi) are here, scripts/abi.sh, too.

Each check is then repeated on a change that it must notice. Exit status 77: nothing is stored for
this processor or this standard library."""
import lzma
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree
from pathlib import Path

PUBLIC = re.compile(r"_ZNK?8cullhull2v1")


def classes_in(node, scope):
    """The classes and enumerations of a namespace or class, each with its full name."""
    for child in node:
        if child.tag in ("class-decl", "enum-decl"):
            name = f"{scope}::{child.get('name')}"
            if child.get("is-declaration-only") or child.get("is-anonymous") or "<" in name:
                continue
            yield name, child
            yield from classes_in(child, name)
        elif child.tag == "member-type" and child.get("access") == "public":
            yield from classes_in(child, scope)


def assertions(dump):
    """What the dump says of the public types, as a program that compiles if it is still so."""
    said = {}
    for unit in dump.iter("abi-instr"):
        for outer in unit.iter("namespace-decl"):
            if outer.get("name") != "cullhull":
                continue
            for inner in outer.findall("namespace-decl[@name='v1']"):
                said |= dict(classes_in(inner, "cullhull"))
    lines = []
    for name, node in sorted(said.items()):
        if node.tag == "enum-decl":
            lines += [f"static_assert(static_cast<int>({name}::{e.get('name').split('::')[-1]}) == "
                      f"{e.get('value')}, \"{name}\");" for e in node.findall("enumerator")]
            continue
        size = int(node.get("size-in-bits")) // 8
        lines.append(f'static_assert(sizeof({name}) == {size}, "{name} had {size} bytes");')
        for member in node.findall("data-member"):
            if member.get("access") != "public" or member.get("static") == "yes":
                continue
            field = member.find("var-decl").get("name")
            at = int(member.get("layout-offset-in-bits")) // 8
            lines.append(f'static_assert(offsetof({name}, {field}) == {at}, '
                         f'"{name}::{field} was at byte {at}");')
    return lines


def changed_layouts(compiler, headers, lines):
    """What the compiler says of lines that no longer hold, and "" if all do."""
    names = sorted(h.name for h in headers.glob("cullhull/*.hpp") if h.name != "mpi.hpp")
    text = "".join(f"#include <cullhull/{name}>\n" for name in names) + "#include <cstddef>\n"
    done = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-Wno-invalid-offsetof",
                           f"-I{headers}", "-x", "c++", "-"], input=text + "\n".join(lines),
                          capture_output=True, text=True)
    return done.stderr if done.returncode else ""


def visible_symbols(archives):
    """Those that a shared library of these exports: (strong, weak) names."""
    strong, weak = set(), set()
    said = subprocess.run(["readelf", "-sW", *archives], capture_output=True, text=True, check=True)
    for line in said.stdout.splitlines():
        words = line.split()
        if len(words) == 8 and words[5] == "DEFAULT" and words[6] != "UND":
            if words[4] == "GLOBAL":
                strong.add(words[7])
            elif words[4] in ("WEAK", "UNIQUE"):
                weak.add(words[7])
    return strong, weak


def changed_symbols(dump, strong, weak):
    stored = {s.get("name") for s in dump.iter("elf-symbol") if s.get("binding") == "global-binding"
              and s.get("is-defined") == "yes"}
    problems = [f"gone: {s}" for s in sorted(stored - strong)]
    problems += [f"new: {s}" for s in sorted(strong - stored)]
    problems += [f"visible, but not public: {s}" for s in sorted(weak)
                 if "8cullhull8internal" in s]
    return problems


def status_of_script(source, library):
    done = subprocess.run([str(source / "scripts/abi.sh"), "--check", str(library)],
                          capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def main():
    source, compiler, *archives = sys.argv[1:]
    source = Path(source)
    stored = source / "packaging/abi" / f"libcullhull-{platform.machine()}.abi.xz"
    probe = subprocess.run([compiler, "-dM", "-E", "-x", "c++", "-include", "cstddef", "/dev/null"],
                           capture_output=True, text=True)
    if not stored.exists() or "__GLIBCXX__" not in probe.stdout or "__linux__" not in probe.stdout:
        print("left out: the stored interface is of another processor or standard library")
        return 77
    text = lzma.decompress(stored.read_bytes()).decode()
    dump = ElementTree.fromstring(text)
    problems, missed = [], []

    lines = assertions(dump)
    if said := changed_layouts(compiler, source / "include", lines):
        problems.append(said)
    strong, weak = visible_symbols(archives)
    problems += changed_symbols(dump, strong, weak)
    functions = sum(1 for s in strong if PUBLIC.match(s))
    print(f"{len(lines)} statements about layouts, {functions} exported functions")

    # Would it be noticed?
    options = source / "include/cullhull/options.hpp"
    for what, old, new in [
        ("a member removed", "  unsigned threads = 0;\n", ""),
        ("a member added", "  std::uint64_t memory_budget = 0;\n",
         "  std::uint64_t memory_budget = 0;\n  int more = 0;\n"),
        ("a member renamed", "  int device = -1;\n", "  int gpu = -1;\n"),
        ("an enumerator inserted", "enum class Backend { automatic, cpu,",
         "enum class Backend { automatic, other, cpu,"),
    ]:
        with tempfile.TemporaryDirectory() as folder:
            shutil.copytree(source / "include", folder, dirs_exist_ok=True)
            assert old in options.read_text(), f"options.hpp has no {old!r}"
            (Path(folder) / "cullhull/options.hpp").write_text(options.read_text().replace(old, new))
            if not changed_layouts(compiler, Path(folder), lines):
                missed.append(what)
    hull = next(s for s in strong if s.startswith("_ZN8cullhull2v111convex_hullE"))
    if len(changed_symbols(dump, strong - {hull} | {hull.replace("convex", "concav")}, weak)) < 2:
        missed.append("a function renamed")
    if not changed_symbols(dump, strong, weak | {"_ZN8cullhull8internal4hull3runEv"}):
        missed.append("an internal symbol")

    library = source / "build/abi/src/shared/libcullhull.so"
    if not shutil.which("abidiff"):
        print("left out: libabigail (Debian: abigail-tools)")
    else:
        with tempfile.TemporaryDirectory() as folder:
            member = re.compile(r" *<data-member access='public' layout-offset-in-bits='\d+'>\s*"
                                r"<var-decl name='backend'.*?</data-member>\n", re.S)
            for what, changed, status in [
                ("nothing changed", text, 0), ("a function renamed", text.replace(
                    hull, hull.replace("convex", "concav")), 1),
                ("a member removed", member.sub("", text), 1),
            ]:
                assert status == 0 or changed != text, what
                copy = Path(folder) / "changed.abi"
                copy.write_text(changed)
                found, said = status_of_script(source, copy)
                if found != status:
                    missed.append(f"by scripts/abi.sh: {what}: status {found}\n{said}")
        if library.exists():
            found, said = status_of_script(source, library)
            print("scripts/abi.sh:", said.strip().splitlines()[-1])
            if found != 0:
                problems.append(said)
        else:
            print("left out: scripts/abi.sh on a library with debug information (preset abi)")

    for problem in problems:
        print(problem)
    for what in missed:
        print("not noticed:", what)
    if problems:
        print('docs/building.md, "The binary interface", says what to do')
    return 1 if problems or missed else 0


if __name__ == "__main__":
    sys.exit(main())
