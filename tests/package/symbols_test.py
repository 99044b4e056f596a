#!/usr/bin/env python3
"""No internal symbol is exported: symbols_test.py HEADERS ARCHIVE [ARCHIVE ...]

A shared library of these archives exports their visible symbols. Those of cullhull::internal are
allowed only where a public header declares the function or defines the class."""
import re
import subprocess
import sys
from pathlib import Path

headers, *archives = sys.argv[1:]
declared = "".join(path.read_text() for path in Path(headers).glob("*.hpp"))
symbols = []
for line in subprocess.run(["readelf", "-sW", *archives], capture_output=True, text=True,
                           check=True).stdout.splitlines():
    words = line.split()
    if (len(words) == 8 and words[4] in ("GLOBAL", "WEAK", "UNIQUE") and words[5] == "DEFAULT"
            and words[6] != "UND" and "8cullhull" in words[7]):
        symbols.append(words[7])
names = subprocess.run(["c++filt"], input="\n".join(symbols), capture_output=True, text=True,
                       check=True).stdout.splitlines()
internal = {n for n in names if re.match(r"(\w+ (table |info |name )?for )?cullhull::internal::", n)}
allowed = {n for n in internal if (m := re.search(r"cullhull::internal::(\w+)", n))
           and re.search(rf"\b{m[1]}\(|\b(struct|class) {m[1]}\b[^;]*\{{", declared)}
print(f"{len(set(names))} exported symbols, {len(allowed)} internal ones that headers declare")
assert any(n.startswith("cullhull::convex_hull(") for n in names), "no symbol of the library is found"
for name in sorted(internal - allowed):
    print("exported, but not public:", name)
sys.exit(bool(internal - allowed))
