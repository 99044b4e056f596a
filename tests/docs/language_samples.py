#!/usr/bin/env python3
"""language_samples.py HEADER_FOLDER LIBRARY_FOLDER [--all]: compiles and runs the samples of
docs/how-to/languages.md, each in its language, which must print what the page says. A language that
is not installed is named and left out, with --all a fault, but for Julia, which Debian does not
have. Exit status 77: not even a C compiler."""

import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import samples

HEADERS, LIBRARY = map(os.path.abspath, sys.argv[1:3])
FLAGS = [f"-I{HEADERS}", f"-L{LIBRARY}"]
# What must be found, the name of the file, and the commands: the last one prints.
WAYS = {
    "c": (["gcc"], "a.c", [["gcc", "-std=c11", *FLAGS, "a.c", "-lcullhull_c", "-o", "a"], ["./a"]]),
    "py": (["python3"], "a.py", [["python3", "a.py"]]),
    "rust": (["rustc"], "a.rs", [["rustc", "-L", LIBRARY, "a.rs"], ["./a"]]),
    "go": (["go"], "a.go", [["go", "run", "a.go"]]),
    "csharp": (["mcs", "mono"], "a.cs", [["mcs", "a.cs"], ["mono", "a.exe"]]),
    "julia": (["julia"], "a.jl", [["julia", "a.jl"]]),
    "r": (["R", "pkg-config"], "a.R",
          [["R", "CMD", "build", "--no-build-vignettes", str(samples.ROOT / "bindings/r")],
           ["sh", "-c", "R CMD INSTALL -l . cullhull_*.tar.gz"], ["Rscript", "a.R"]]),
    "octave": (["mkoctfile", "octave-cli"], "a.m",
               [["mkoctfile", "--mex", *FLAGS, "volume.c", "-lcullhull_c"], ["octave-cli", "a.m"]]),
}


def run(language, block, glue):
    """None, or what is wrong."""
    _, name, commands = WAYS[language]
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, name).write_text(block.text)
        if glue:
            Path(folder, "volume.c").write_text(glue)
        env = dict(os.environ, LD_LIBRARY_PATH=LIBRARY, CGO_CFLAGS=f"-I{HEADERS}",
                   CGO_LDFLAGS=f"-L{LIBRARY}", GOCACHE=folder + "/go", GOPATH=folder + "/path",
                   PKG_CONFIG_PATH=LIBRARY, R_LIBS=folder)
        for command in commands:
            done = subprocess.run(command, cwd=folder, env=env, capture_output=True, text=True)
            if done.returncode != 0:
                return f"{' '.join(command)}: {done.stderr.strip() or done.stdout.strip()}"
        if not samples.matches(block.output, "\n".join(s.rstrip() for s in done.stdout.split("\n"))):
            return f"printed {done.stdout!r}"
    return None


def main():
    if not shutil.which("gcc"):
        sys.exit(77)
    wrong, ran, glue = 0, [], None
    for block in samples.blocks(samples.ROOT / "docs/how-to/languages.md"):
        if block.language not in WAYS or block.output is None and "main(" in block.text:
            continue
        if block.language == "c" and block.output is None:
            glue = block.text  # of the language that follows
            continue
        if block.output is None:
            continue
        missing = [tool for tool in WAYS[block.language][0] if not shutil.which(tool)]
        if missing:
            print(f"left out: {block.language}, without {missing[0]}")
            wrong += "--all" in sys.argv and block.language != "julia"
            continue
        fault = run(block.language, block, glue)
        ran.append(block.language)
        if fault:
            wrong += 1
            print(f"{block.page}:{block.line}: {block.language}: {fault}")
    print("ran:", *ran)
    sys.exit(1 if wrong or "c" not in ran or "py" not in ran else 0)


main()
