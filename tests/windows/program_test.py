#!/usr/bin/env python3
"""The program for Windows under wine beside Linux's: program_test.py CULLHULL.EXE CULLHULL

The same bytes for every command and format; names with spaces and letters beyond ASCII; line ends
of Windows; standard streams that carry any byte; files replaced whole or not at all; places beyond
4 GB; one line for each error."""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

windows, linux = ["wine", str(Path(sys.argv[1]).resolve())], [str(Path(sys.argv[2]).resolve())]
failed = checks = 0


def check(holds, what):
    global failed, checks
    checks += 1
    if not holds:
        failed += 1
        print("FAILED:", what)


def run(program, *words, given=b"", folder="."):
    ended = subprocess.run([*program, *words], input=given, capture_output=True, cwd=folder)
    # wine's own remark where its server has ended a process before one of its threads.
    ended.stderr = re.sub(rb"wine client error:[0-9a-f]+: [^\n]*\n?", b"", ended.stderr)
    return ended


def same(words, outputs=(), given=b"", folder=".", status=0):
    """Both end with this status and print and write the same; what Linux's printed."""
    ends = []
    for program in (windows, linux):
        ended = run(program, *words, given=given, folder=folder)
        files = {name: (Path(folder) / name) for name in outputs}
        ends.append((ended.returncode, ended.stdout, ended.stderr,
                     {name: file.read_bytes() if file.exists() else None
                      for name, file in files.items()}))
        for file in files.values():
            file.unlink(missing_ok=True)
    (code, out, err, written), theirs = ends
    check(theirs[0] == status and None not in (theirs[3] if not status else {}).values(),
          f"{words}: {theirs[0]} on Linux: {theirs[2]!r}")
    check((code, out, err) == theirs[:3], f"{words}: {(code, out[-300:], err)} but {theirs[:3]}")
    check(written == theirs[3], f"{words}: other bytes in {list(outputs)}")
    return theirs[1]


folder = Path(tempfile.mkdtemp(prefix="cullhull windows Größe жук "))
for kind, n, d in (("ball", 20000, 3), ("disk", 5000, 2), ("ball", 300, 4)):
    same(["generate", kind, "-n", str(n), "-d", str(d), "-o", f"{d}.npy", "-q"], [f"{d}.npy"],
         folder=folder)
    run(linux, "generate", kind, "-n", str(n), "-d", str(d), "-o", f"{d}.npy", folder=folder)

# Commands and formats, from a folder whose name is no ASCII, and into another.
(folder / "späte Hüllen").mkdir()
to = "späte Hüllen/"
for d, endings in ((3, "json ply obj off stl vtp glb"), (2, "json geojson wkt ply"), (4, "json")):
    for ending in endings.split():
        out = f"{to}h.{ending}"
        same(["hull", f"{d}.npy", "-q", "--certify", "-o", out], [out], folder=folder)
for words, ending in ((["delaunay", "2.npy"], "ply"), (["delaunay", "3.npy"], "json"),
                      (["voronoi", "2.npy"], "geojson"),
                      (["alpha", "2.npy", "--alpha", "0.1"], "geojson"),
                      (["cull", "3.npy"], "ply"), (["cull", "3.npy"], "xyz")):
    same([*words, "-q", "-o", f"{to}r.{ending}"], [f"{to}r.{ending}"], folder=folder)
same(["--help"])
same(["help", "formats"])
same(["man", "hull"])

# Text with the line ends of Windows, patterns, lists of files, folders.
rows = ["x,y,z", "0,0,0", "1,0,0", "0,1,0", "0,0,1", "0.1,0.1,0.1"]
(folder / "crlf é.csv").write_bytes("\r\n".join(rows).encode() + b"\r\n")
(folder / "lf.csv").write_bytes("\n".join(rows).encode() + b"\n")
(folder / "list.txt").write_bytes("# files\r\ncrlf é.csv\r\n\r\nlf.csv\r\n".encode())
same(["hull", "crlf é.csv", "-q", "-o", "c.json"], ["c.json"], folder=folder)
same(["hull", "@list.txt", "-q", "-o", "c.json"], ["c.json"], folder=folder)
same(["hull", "*.csv", "-q", "-o", "c.json"], ["c.json"], folder=folder)
(folder / "Ordner").mkdir()
(folder / "Ordner" / "ä.csv").write_bytes("\r\n".join(rows).encode())
same(["hull", "Ordner", "-q", "-o", "c.json"], ["c.json"], folder=folder)

# Standard streams: a ^Z, line ends and zeros are bytes as others are.
odd = b"\x1a\r\n\n\x00\x1a" * 8
head = b"{'descr':'|u1','fortran_order':False,'shape':(24,2)}\n"
npy = b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head + odd
same(["cull", "-", "-q", "-o", "-"], given=npy)
same(["cull", "-", "-q", "-o", "-"],
     given="\r\n".join(row.replace(",", " ") for row in rows[1:]).encode())

# What is there is replaced whole, or stays.
(folder / "old.json").write_bytes(b"old")
check(run(windows, "hull", "absent.npy", "-o", "old.json", folder=folder).returncode == 1, "absent")
check((folder / "old.json").read_bytes() == b"old", "an error left another file")
same(["hull", "3.npy", "-q", "-o", "old.json"], ["old.json"], folder=folder)
check(not list(folder.glob("**/*.tmp")), "a temporary file was left")
for words, status in ((["hull", "absent é.npy"], 1), (["hull", "3.npy", "-o", "no/such/x.ply"], 1),
                      (["hull", "lf.csv", "--columns", "a,b"], 2), (["hulk", "3.npy"], 2),
                      (["hull", "3.npy", "-o", "3.npy"], 2)):
    same(words, folder=folder, status=status)
# By Windows' shell, since wine knows no file of what a shell of Unix redirects.
run(linux, "cull", "3.npy", "-q", "-o", "s.ply", folder=folder)
program = "Z:" + windows[1].replace("/", "\\")
ended = run(["wine", "cmd", "/c"], f"{program} hull - -o s.ply <s.ply", folder=folder)
check((ended.returncode, ended.stderr.strip()) ==
      (2, b"cullhull: -o s.ply: would overwrite the input standard input"), str(ended))

# Beyond 4 GB, of which the last part is read.
count = 2_200_000_000
head = f"{{'descr':'|u1','fortran_order':False,'shape':({count},2)}}".encode()
head = b"\x93NUMPY\x01\x00" + len(head).to_bytes(2, "little") + head
with open(folder / "big.npy", "wb") as big:
    big.write(head)
    big.seek(len(head) + 2 * count - 8)
    big.write(bytes([0, 0, 9, 1, 3, 8, 2, 2]))
same(["hull", "big.npy", "--part", "22000/22000", "-q", "-o", "p.hullstate"], ["p.hullstate"],
     folder=folder)

subprocess.run(["rm", "-rf", str(folder)], check=True)
print(f"program_test: {checks} checks, {failed} failed")
sys.exit(failed > 0)
