#!/usr/bin/env python3
"""header_test.py HEADER LIBRARY: C11 and C++98 compilers read the header without a warning, and the
library shows the functions that it declares and nothing else. Exit status 77: no compiler."""

import re
import shutil
import subprocess
import sys

header, library = sys.argv[1:]
ran = 0
for compiler, flags in (("gcc", "-std=c11 -x c"), ("clang", "-std=c11 -x c"),
                        ("g++", "-std=c++98 -x c++"), ("clang++", "-std=c++98 -x c++")):
    if shutil.which(compiler):
        ran += 1
        subprocess.run([compiler, *flags.split(), "-Wall", "-Wextra", "-pedantic", "-Werror",
                        "-Wno-pragma-once-outside-header", "-fsyntax-only", header], check=True)
if not ran:
    sys.exit(77)
declared = set(re.findall(r"\b(cullhull_\w+)\(", re.sub(r"/\*.*?\*/", "", open(header).read(),
                                                        flags=re.S)))
listed = subprocess.run(["nm", "-D", "--defined-only", library], capture_output=True, text=True,
                        check=True).stdout.splitlines()
shown = {line.split()[-1].split("@")[0] for line in listed if line.split()[-2] != "A"}
print(f"{ran} compilers; {len(declared)} functions are declared, {len(shown)} shown")
for name in sorted(declared ^ shown):
    print("declared, not shown:" if name in declared else "shown, not declared:", name)
sys.exit(declared != shown or len(declared) < 40)
