#!/usr/bin/env python3
"""follow_pages.py PAGE[#SECTION] ...: prints a bash script that does what the pages tell a reader to do,
word by word; scripts/follow-docs.sh runs it in an empty root. Each page begins in a new folder.

Of README.md and docs/install.md these are the `bash` blocks and the indented commands (of a section,
if one is named); of a tutorial the commands of its `console` and `sh` blocks in the source tree, its
Python examples (doctest, in the environment that docs/install.md made), and its C++ programs, which
are built by the page's own CMake file and must print the text below them. Left out is `make test`,
unless FOLLOW_TESTS=1: it takes an hour."""

import os
import re
import shlex
import sys

import samples
from shell_samples import commands as shell_commands

HOME = "/root"
ENVIRONMENT = f"{HOME}/install/cullhull/venv"  # made by docs/install.md


def slug(heading):
    return re.sub(r"[^\w -]", "", heading.lower()).strip().replace(" ", "-")


def section(text, wanted):
    """The part of a page below a heading; the page's beginning and its first block always belong to it."""
    if not wanted:
        return text
    parts = re.split(r"^(?=#+ )", text, flags=re.M)
    chosen = [p for p in parts if p and slug(p.split("\n")[0].lstrip("#")) == wanted]
    if len(chosen) != 1:
        sys.exit(f"follow_pages: no section '{wanted}'")
    return parts[0] + (parts[1] if parts[0] == "" else "") + chosen[0]


def installing(text):
    """The commands of `bash` blocks and of indented blocks, in order; lines that go on are joined."""
    pattern = r"^```bash\n(?P<fenced>.*?)^```$|^(?P<indented>(?: {4}\S[^\n]*\n)+)"
    for match in re.finditer(pattern, re.sub(r"^```(?!bash)\w+\n.*?^```$", "", text, flags=re.M | re.S), re.M | re.S):
        block = match["fenced"] or re.sub(r"^ {4}", "", match["indented"], flags=re.M)
        for line in re.sub(r"(\\|&&)\n\s*", lambda m: "&& " if m[1] == "&&" else "", block).splitlines():
            if re.match(r"make test\b", line) and os.environ.get("FOLLOW_TESTS") != "1":
                continue
            yield line


def tutorial(path):
    """The commands of a tutorial, which is read in the source tree."""
    blocks = samples.blocks(path)
    for block in blocks:
        if block.language in ("sh", "console"):
            for line, _ in shell_commands(block):
                yield line
    if any(">>> " in block.text for block in blocks if block.language == "python"):
        page = f"{HOME}/cullhull/{path.relative_to(samples.ROOT)}"
        yield f"(cd / && {ENVIRONMENT}/bin/python -m doctest -o ELLIPSIS {page})"
    cmake = next((b.text for b in blocks if b.language == "cmake"), None) or CMAKE
    for number, block in enumerate(b for b in blocks if b.language == "cpp" and "int main(" in b.text):
        name = re.search(r"add_executable\((\w+) (\S+)\)", cmake)
        files = {"CMakeLists.txt": cmake, name[2]: block.text, "expected": block.output}
        yield f"mkdir project{number}"
        for file, content in files.items():
            yield f"cat >project{number}/{file} <<'END_OF_FILE'\n{content}END_OF_FILE"
        yield f"cmake -S project{number} -B project{number}/build"
        yield f"cmake --build project{number}/build"
        yield f"project{number}/build/{name[1]} | diff - project{number}/expected"


CMAKE = next(b.text for b in samples.blocks(samples.ROOT / "docs/tutorials/cpp.md") if b.language == "cmake")


def main():
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    # `set -e` would pass over a failing first command of `first && second`.
    print("set -o pipefail")
    print('check() { local status=$?; [[ $status -eq 0 ]] || { echo "follow: exit status $status"; exit 1; }; }')
    for argument in sys.argv[1:]:
        name, _, wanted = argument.partition("#")
        path = samples.ROOT / name
        folder = f"{HOME}/{path.stem.lower()}" + (f"-{wanted}" if wanted and path.stem != "install" else "")
        if path.parent.name == "tutorials":
            print(f"rm -rf {folder}")
        print(f"mkdir -p {folder} && cd {folder}; check")
        if path.parent.name == "tutorials":
            print(f"cp -r {HOME}/cullhull/data .; check")
            lines = list(tutorial(path))
        else:
            lines = list(installing(section(path.read_text(), wanted)))
        if not lines:
            sys.exit(f"follow_pages: {argument} tells nobody to do anything")
        for line in lines:
            if re.match(r"git clone\b", line):
                # Where a root is used again, the clone is there and is brought up to date.
                update = "git -C cullhull fetch -q origin HEAD && git -C cullhull checkout -q FETCH_HEAD"
                line = f"if [[ -e cullhull ]]; then {update}; else {line.split(' && ')[0]}; fi && cd cullhull"
            print(f"echo {shlex.quote('follow: ' + argument + ': ' + line.splitlines()[0])}\n{line}\ncheck")
    print("echo 'follow: all of it worked'")


if __name__ == "__main__":
    main()
