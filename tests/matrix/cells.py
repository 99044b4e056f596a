"""The tally: what became of each cell, and what is said at the end."""

from __future__ import annotations

import os
import pickle
import re
import signal
import sys
import threading
import traceback
from collections import Counter
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Callable, Sequence

#: How many failures are shown in full.
SHOWN = 60


class Cells:
    """Safe to use from several threads."""

    def __init__(self, expected: Sequence[tuple[str, str]], only: str | None) -> None:
        self._lock = threading.Lock()
        self._expected = expected
        self._only = only
        self.at: Path | None = None  #: a file that holds the cell being tried
        self.passed = 0
        self.reasons: Counter[str] = Counter()
        self.known: Counter[str] = Counter()
        self.failures: list[tuple[str, str, str]] = []

    def wanted(self, start: str) -> bool:
        """Whether cells whose names begin so are to be tried."""
        if self._only is None:
            return True
        parts = self._only.split("/")
        return all(fnmatchcase(a, b) for a, b in zip(start.split("/"), parts))

    def starts(self, cell: str, line: str) -> None:
        """Notes what is tried now, for the case that the process dies of it."""
        if self.at is not None:
            self.at.write_text(f"{cell}\n{line}")

    def no_meaning(self, cell: str, why: str) -> None:
        with self._lock:
            self.reasons[why] += 1

    def judge(self, cell: str, fault: str | None, reproduce: str) -> None:
        """One cell that has a meaning: `fault` is None where it holds."""
        if not self.wanted(cell):
            return
        with self._lock:
            pattern = next((p for p, _ in self._expected if fnmatchcase(cell, p)), None)
            if fault is None:
                self.passed += 1
            elif pattern is not None:
                self.known[pattern] += 1
            else:
                self.failures.append((cell, fault, reproduce))

    def taken(self) -> tuple[int, Counter[str], Counter[str], list[tuple[str, str, str]]]:
        """The tally, which starts afresh."""
        with self._lock:
            held = self.passed, self.reasons, self.known, self.failures
            self.passed, self.reasons, self.known, self.failures = 0, Counter(), Counter(), []
        return held

    def add(self, tally: tuple[int, Counter[str], Counter[str], list[tuple[str, str, str]]]) -> None:
        with self._lock:
            self.passed += tally[0]
            self.reasons += tally[1]
            self.known += tally[2]
            self.failures += tally[3]

    def shows(self, folder: Path) -> bool:
        """Whether a failure's command line names files of this folder."""
        with self._lock:
            return any(f"{folder}/" in line for _, _, line in self.failures)

    def finish(self, complete: bool) -> int:
        """Prints the tally; the exit status."""
        if complete:
            for pattern, _ in self._expected:
                if not self.known[pattern]:
                    self.failures.append((pattern, "fails no more: take it off known.py", ""))
        self._show_failures()
        if self.known:
            print("Expected failures:")
            whys = dict(self._expected)
            for pattern, count in sorted(self.known.items()):
                print(f"  {count:6} {pattern}: {whys[pattern]}")
        print("Without a meaning:")
        for why, count in self.reasons.most_common():
            print(f"  {count:6} {why}")
        print(
            f"matrix: {self.passed} cells passed, {sum(self.reasons.values())} without meaning, "
            f"{sum(self.known.values())} expected failures, {len(self.failures)} failed"
        )
        return 1 if self.failures else 0

    def _show_failures(self) -> None:
        kinds: dict[tuple[str, str], list[tuple[str, str, str]]] = {}
        for failure in sorted(self.failures):
            kinds.setdefault(_kind(failure), []).append(failure)
        for alike in sorted(kinds.values(), key=len, reverse=True)[:SHOWN]:
            cell, fault, reproduce = alike[0]
            print(f"FAILED {cell}: {fault}\n    {reproduce}")
            if len(alike) > 1:
                sets = sorted({c.split("/")[3] for c, _, _ in alike if c.count("/") > 3})
                print(f"    and {len(alike) - 1} more alike, of {' '.join(sets)}")
        if len(kinds) > SHOWN:
            print(f"and {len(kinds) - SHOWN} more kinds of failures")


def forked(cells: Cells, folder: Path, work: Callable[..., None], *given: Any) -> None:
    """work(*given) in a process of its own: where it dies, the cell it was at is a failure."""
    told, at = folder / f"{os.getpid()}.tally", folder / f"{os.getpid()}.at"
    told.unlink(missing_ok=True)
    at.write_text(getattr(work, "__qualname__", str(work)))
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        status = 1
        try:
            cells.taken()
            cells.at = at
            work(*given)
            told.write_bytes(pickle.dumps(cells.taken()))
            status = 0
        finally:
            if status:
                traceback.print_exc()
            sys.stderr.flush()
            os._exit(status)
    _, status = os.waitpid(child, 0)
    if status == 0:
        cells.add(pickle.loads(told.read_bytes()))
    else:
        cell, _, line = at.read_text().partition("\n")
        cells.judge(cell, f"the process died: {_ending(status)}", line)


def _ending(status: int) -> str:
    if os.WIFSIGNALED(status):
        return signal.Signals(os.WTERMSIG(status)).name
    return f"status {os.waitstatus_to_exitcode(status)}"


def _kind(failure: tuple[str, str, str]) -> tuple[str, str]:
    """Row and door, and the fault without names and numbers: failures alike are shown once."""
    cell, fault, _ = failure
    words = re.sub(r"/\S*/", "", fault)
    return "/".join(cell.split("/")[:3]), re.sub(r"b'.*|-?\d[\w.+-]*", "#", words)[:60]
