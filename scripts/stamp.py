#!/usr/bin/env python3
"""The version and the repository's address, which some files must repeat:

    scripts/stamp.py                            check that all of them agree (exit status 1 if not)
    scripts/stamp.py --version 1.2.0            write another version into all of them
    scripts/stamp.py --repository URL           write another address into all of them

The version stands in include/cullhull/version.hpp, the address in packaging/repository.txt; CMake,
pip, Conan and the program read them there. The places below cannot read, so they are written and
checked here.
"""

import argparse
import re
import subprocess
import sys
from pathlib import Path

root = Path(__file__).resolve().parents[1]
header = root / "include/cullhull/version.hpp"
address = root / "packaging/repository.txt"

#: Where a version stands: a file, and what stands before and after each of them.
VERSIONS = [
    ("CITATION.cff", r"^(version: )(.+)()$"),
    ("packaging/README.md", r"(cullhull@)(\d[\w.]*\w)()"),
    ("packaging/conda/meta.yaml", r'(set version = ")(.+)(")'),
    ("packaging/docker/Dockerfile", r"(cullhull:)(\d[\w.]*\w)()"),
    ("packaging/docker/Dockerfile", r'(image\.version=")([^"]+)(")'),
    ("packaging/homebrew/cullhull.rb", r'^(  version ")(.+)(")'),
    ("packaging/spack/cullhull/package.py", r"(cullhull@)(\d[\w.]*\w)()"),
    ("packaging/spack/cullhull/package.py", r'^(    version\(")([^"]+)(")'),
    ("packaging/vcpkg/cullhull/vcpkg.json", r'^(  "version": ")(.+)(")'),
    ("tests/package/consumer/CMakeLists.txt", r"(find_package\(cullhull )([\d.]+)()"),
    ("tests/package/mpi_consumer/CMakeLists.txt", r"(find_package\(cullhull )([\d.]+)()"),
]

#: Addresses of a repository or site with the project's name, however they are spelled.
ADDRESSES = re.compile(
    r"(github\.com[/:]|githubusercontent\.com/|img\.shields\.io/github/[\w/-]+?/)([\w.-]+/{name})\b"
    r"|([\w-]+\.github\.io/{name})\b".replace("{name}", "cullhull")
)
PLACEHOLDER = re.compile(r"<(this|your) repository>|OWNER/cullhull|@localhost>")


def version() -> str:
    found = re.search(r'#define CULLHULL_VERSION "(.+)"', header.read_text(encoding="utf-8"))
    if found is None:
        sys.exit(f"stamp: no version in {header}")
    return found[1]


def repository() -> str:
    return address.read_text(encoding="utf-8").strip()


def slug(url: str) -> str:
    """OWNER/NAME of an address."""
    found = re.fullmatch(r"https://github\.com/([\w.-]+/[\w.-]+)", url)
    if found is None:
        sys.exit(f"stamp: '{url}' is not https://github.com/OWNER/NAME")
    return found[1]


def site(url: str) -> str:
    owner, name = slug(url).split("/")
    return f"{owner.lower()}.github.io/{name}"


def texts() -> "list[Path]":
    """The files under version control, or all where there is none."""
    ran = subprocess.run(
        ["git", "-C", root, "ls-files", "-z", "-co", "--exclude-standard"],
        capture_output=True,
        text=True,
        check=False,
    )
    if ran.returncode == 0:
        paths = [root / name for name in ran.stdout.split("\0") if name]
    else:
        paths = [path for path in root.rglob("*") if "build" not in path.parts]
    ours = Path(__file__).resolve()
    return [path for path in paths if path.is_file() and path.resolve() != ours]


def read(path: Path) -> "str | None":
    try:
        return path.read_bytes().decode("utf-8")
    except UnicodeDecodeError:
        return None


def faults() -> "list[str]":
    """What does not agree, a line each."""
    found = []
    wanted = version()
    text = header.read_text(encoding="utf-8")
    for number, part in zip(re.split(r"[.-]", wanted), ("MAJOR", "MINOR", "PATCH")):
        if not re.search(rf"^#define CULLHULL_VERSION_{part} {number}$", text, re.M):
            found.append(f"version.hpp: CULLHULL_VERSION_{part} is not {number}")
    for name, pattern in VERSIONS:
        stands = re.findall(pattern, (root / name).read_text(encoding="utf-8"), re.M)
        if not stands:
            found.append(f"{name}: no version where {pattern} is expected")
        found += [f"{name}: version {old}, not {wanted}" for _, old, _ in stands if old != wanted]
    url = repository()
    for path in texts():
        content = read(path)
        if content is None:
            continue
        name = path.relative_to(root)
        found += [f"{name}: {match[0]} stands for an address" for match in PLACEHOLDER.finditer(content)]
        for match in ADDRESSES.finditer(content):
            if match[2] and match[2] != slug(url):
                found.append(f"{name}: {match[0]}, not {url}")
            if match[3] and match[3] != site(url):
                found.append(f"{name}: {match[3]}, not {site(url)}")
    return found


def set_version(new: str) -> None:
    parts = re.fullmatch(r"(\d+)\.(\d+)\.(\d+)", new)
    if parts is None:
        sys.exit(f"stamp: '{new}' is no version such as 1.2.0")
    text = header.read_text(encoding="utf-8")
    for number, part in zip(parts.groups(), ("MAJOR", "MINOR", "PATCH")):
        text = re.sub(rf"(#define CULLHULL_VERSION_{part}) .*", rf"\1 {number}", text)
    text = re.sub(r'(#define CULLHULL_VERSION) ".*"', rf'\1 "{new}"', text)
    header.write_text(text, encoding="utf-8")
    for name, pattern in VERSIONS:
        path = root / name
        text = path.read_text(encoding="utf-8")
        path.write_text(re.sub(pattern, rf"\g<1>{new}\g<3>", text, flags=re.M), encoding="utf-8")


def set_repository(new: str) -> None:
    old_slug, new_slug = slug(repository()), slug(new)
    old_site, new_site = site(repository()), site(new)
    for path in texts():
        content = read(path)
        if content is None or path == address:
            continue
        changed = ADDRESSES.sub(
            lambda found: (found[1] + new_slug if found[2] == old_slug else found[0])
            if found[2]
            else (new_site if found[3] == old_site else found[0]),
            content,
        )
        if changed != content:
            path.write_bytes(changed.encode("utf-8"))
    address.write_text(new + "\n", encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--version", metavar="X.Y.Z", help="the new version")
    parser.add_argument("--repository", metavar="URL", help="https://github.com/OWNER/NAME")
    arguments = parser.parse_args()
    if arguments.version:
        set_version(arguments.version)
    if arguments.repository:
        set_repository(arguments.repository)
    found = faults()
    for line in found:
        print(line, file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
