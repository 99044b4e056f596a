"""How commands end before their time: interrupted, or out of the memory they were given. One cell
each, with an input that takes seconds: nothing half-written is left, and the status says why."""

from __future__ import annotations

import shlex
import signal
import subprocess
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Optional

from program import Program

#: What each command takes some seconds for: {p} is a file of many points, {o} the beginning of the
#: names of what is written.
INTERRUPTED = {
    "hull": ("hull", "{p}", "-q", "--repeat", "200", "-o", "{o}.ply", "--vertices", "{o}.npy"),
    "cull": ("cull", "{p}", "-q", "--repeat", "1000", "-o", "{o}.npy"),
    "delaunay": ("delaunay", "{p}", "-q", "-o", "{o}.json"),
    "voronoi": ("voronoi", "{p}", "-q", "-o", "{o}.json"),
    "alpha": ("alpha", "{p}", "-q", "-o", "{o}.ply"),
    "certify": (
        "certify",
        "{p}",
        "{p}",
        "{p}",
        "{p}",
        "{p}",
        "{p}",
        "{h}",
        "-q",
        "--json={o}.json",
    ),
    "generate": ("generate", "sphere", "-n", "60M", "-q", "-o", "{o}.npy"),
    "info": ("info", "-", "--json={o}.json"),
    "view": ("view", "{p}", "-q", "--delaunay", "-o", "{o}.html"),
    "track": ("track", *["{p}"] * 40, "-q", "--json={o}.json"),
    "qconvex": ("qconvex", "-q", "TI", "{p}", "TO", "{o}.txt", "n", "f"),
}
#: Those that wait for a pipe that never ends, as they would be too quick.
WAITING = ("info", "qconvex")

#: A budget that does not suffice for the points, or does: status 4, or the answer.
BUDGETS = {
    "hull": ("hull", "{p}", "-q", "-o", "{o}.json"),
    "cull": ("cull", "{p}", "-q", "-o", "{o}.npy"),
    "delaunay": ("delaunay", "{p}", "-q", "-o", "{o}.json"),
    "voronoi": ("voronoi", "{p}", "-q", "-o", "{o}.json"),
    "alpha": ("alpha", "{p}", "-q", "-o", "{o}.json"),
    "track": ("track", "{p}", "{p}", "-q", "-o", "{o}-%d.json"),
    "view": ("view", "{p}", "-q", "-o", "{o}.html"),
    "qconvex": ("qconvex", "-q", "TI", "{p}", "TO", "{o}.txt", "n"),
}
_AMOUNTS = ("1K", "64K", "1M", "16M", "1G")


def all_cells(program: Program) -> None:
    folder = program.folder / "ends"
    folder.mkdir()
    wanted = program.cells.wanted("program ends")
    if not wanted:
        return
    many, few = folder / "many.npy", folder / "few.npy"
    program.run(["generate", "sphere", "-n", "400k", "-q", "-o", str(many)])
    program.run(["generate", "ball", "-n", "20k", "-q", "-o", str(few)])
    program.run(["hull", str(many), "-q", "-o", str(folder / "many.json")])
    with ThreadPoolExecutor(2) as pool:
        for name, words in INTERRUPTED.items():
            pool.submit(_interrupted, program, folder, name, words, many)
        for name, words in BUDGETS.items():
            pool.submit(_budget, program, folder, name, words, few)


def _left(folder: Path, stem: str) -> list[str]:
    return sorted(path.name for path in folder.glob(f"{stem}[.-]*"))


def _interrupted(
    program: Program, folder: Path, name: str, words: tuple[str, ...], many: Path
) -> None:
    try:
        for attempt, wait in enumerate((0.6, 0.2, 0.05)):
            stem = f"stop-{name}-{attempt}"
            names = {"p": many, "h": folder / "many.json", "o": folder / stem}
            waits = name in WAITING
            if waits:
                names["p"] = Path("/dev/stdin")
            line = [program.path, *(w.format(**names) for w in words)]
            status, err = _stopped(line, wait, waits)
            if status != 0:
                break
        fault: Optional[str] = None
        left = _left(folder, stem)
        if status == 0:
            fault = "was done before it could be interrupted: give it more points"
        elif status != 130:
            fault = f"status {status}, not 130: {err[:200]!r}"
        elif left:
            fault = f"leaves {left}"
        elif err != "cullhull: cancelled\n":
            fault = f"says {err[:200]!r}"
        program.cells.judge(
            f"program ends/interrupt/{name}", fault, f"timeout -s INT {wait} {shlex.join(line)}"
        )
    except Exception as error:  # in a thread of its own nobody would see it
        program.cells.judge(
            f"program ends/interrupt/{name}", f"{type(error).__name__}: {error}", ""
        )


def _stopped(line: list[str], wait: float, waits: bool) -> tuple[int, str]:
    with subprocess.Popen(
        line, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    ) as running:
        if waits:
            running.stdin.write(b"0 0 1\n1 0 0\n" * 100)
            running.stdin.flush()
        time.sleep(wait)
        running.send_signal(signal.SIGINT)
        try:
            running.wait(timeout=60)
        except subprocess.TimeoutExpired:
            running.kill()
            return -9, "did not stop within 60 s of Ctrl-C"
        return running.returncode, running.stderr.read().decode(errors="replace")


def _budget(program: Program, folder: Path, name: str, words: tuple[str, ...], few: Path) -> None:
    names = {"p": few, "o": folder / f"budget-{name}-free"}
    free = program.run([w.format(**names) for w in words])
    answer = {
        n.split("-free")[1]: (folder / n).read_bytes() for n in _left(folder, f"budget-{name}-free")
    }
    for amount in _AMOUNTS:
        stem = f"budget-{name}-{amount}"
        names["o"] = folder / stem
        ran = program.run([*(w.format(**names) for w in words), "--memory", amount])
        written = {n.split(f"-{amount}")[1]: (folder / n).read_bytes() for n in _left(folder, stem)}
        fault = None
        if free.status != 0 or not answer:
            fault = f"without a budget status {free.status}: {free.err[:200]!r}"
        elif ran.status == 0 and name != "view" and written != answer:
            fault = "another answer than without a budget"
        elif ran.status not in (0, 4):
            fault = f"status {ran.status}: {ran.err[:200]!r}"
        elif ran.status == 4 and (written or len(ran.err.splitlines()) != 1):
            fault = f"refused, but leaves {sorted(written)} and says {ran.err[:200]!r}"
        elif amount == _AMOUNTS[-1] and ran.status != 0:
            fault = f"20,000 points do not fit into {amount}: {ran.err[:200]!r}"
        program.cells.judge(f"program ends/budget/{name}/{amount}", fault, ran.line)
