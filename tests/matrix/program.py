"""The cells of the program: rows × doors × sets × outputs."""

from __future__ import annotations

import json
import os
import re
import shlex
import shutil
import subprocess
import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Optional

import numpy as np

import files
from alike import difference
from cells import Cells
from commands import FEW_DOORS, FEW_SETS, ROWS, WAYS, Output, Row
from doors import DOORS, REFERENCE, SEQUENCES, Door, Entry
from schema import fault_of
from sets import PointSet

#: Seconds after which a command hangs.
PATIENCE = 120
_POINT = re.compile(r"point \d+, coordinate \d+ is (?:NaN|infinite)")


@dataclass
class Ran:
    status: int
    out: bytes
    err: str
    line: str  #: to be pasted into a shell


@dataclass
class Answer:
    """What the reference door gave for a row and a set."""

    line: str = ""
    fault: Optional[str] = None
    written: dict[str, bytes] = field(default_factory=dict)
    error: str = ""


class Program:
    def __init__(self, path: str, folder: Path, cells: Cells, schema: Any, large: bool) -> None:
        self.path, self.folder, self.cells = path, folder, cells
        self.schema, self.large = schema, large
        self.helps: dict[str, str] = {}
        self.lock = threading.Lock()
        self.runs = 0  #: processes started

    # What the program says about itself

    def run(self, words: list[str], stdin: bytes | None = None, cwd: Path | None = None) -> Ran:
        feed = "" if stdin is None else f"cat {self._kept(cwd, stdin)} | "
        line = feed + shlex.join([self.path, *words])
        try:
            done = subprocess.run(
                [self.path, *words],
                input=b"" if stdin is None else stdin,
                capture_output=True,
                timeout=PATIENCE,
                check=False,
            )
            self.runs += 1
        except subprocess.TimeoutExpired:
            return Ran(-1, b"", f"no answer in {PATIENCE} s", line)
        return Ran(done.returncode, done.stdout, done.stderr.decode(errors="replace"), line)

    @staticmethod
    def _kept(cwd: Path | None, stdin: bytes) -> str:
        if cwd is None:
            return "STDIN"
        path = cwd / "stdin"
        path.write_bytes(stdin)
        return str(path)

    def help_of(self, command: str) -> str:
        if command not in self.helps:
            self.helps[command] = self.run([*([command] if command else []), "--help"]).out.decode()
        return self.helps[command]

    def options_of(self, command: str) -> set[str]:
        return set(re.findall(r"^  (?:-\w,)?(--[\w-]+)", self.help_of(command), re.M))

    # Cells

    def all_cells(self, sets: list[PointSet]) -> None:
        for s in sets:
            (self.folder / s.name).mkdir(parents=True, exist_ok=True)
        with ThreadPoolExecutor((os.cpu_count() or 2) + 1) as pool:
            for done in [pool.submit(self._row_of_set, row, s) for s in sets for row in ROWS]:
                done.result()

    def _row_of_set(self, row: Row, s: PointSet) -> None:
        if not self.cells.wanted(f"program/{row.name}"):
            return
        reason = row.reason(s)
        if reason is not None:
            for output in row.outputs:
                self.cells.no_meaning(f"program/{row.name}/*/{s.name}/{output.name}", reason)
            return
        folder = self.folder / s.name / re.sub(r"\W+", "-", row.name)
        folder.mkdir(exist_ok=True)
        reference = self._reference(row, s, folder)
        for door in SEQUENCES if row.shape == "sequence" else ():
            self._try_door(row, door, s, folder, reference)
        for door in DOORS:
            if door.name != REFERENCE:
                self._try_door(row, door, s, folder, reference)
        self._try_ways(row, s, folder, reference)
        if not self.cells.shows(folder):
            shutil.rmtree(folder)

    def _reference(self, row: Row, s: PointSet, folder: Path) -> Answer:
        door = next(d for d in DOORS if d.name == REFERENCE)
        place = folder / door.name
        place.mkdir(exist_ok=True)
        entry = self._enter(row, door, s, place)
        asked = [o for o in row.outputs if o.reason(s) is None]
        answer = Answer()
        ran, faults = self._ask(row, s, entry, asked, place, answer.written)
        answer.line, answer.error = ran.line, ran.err
        for output in asked:
            cell = f"program/{row.name}/{door.name}/{s.name}/{output.name}"
            fault = faults or self._unreadable(row, s, output, answer.written)
            answer.fault = answer.fault or fault
            self.cells.judge(cell, fault, ran.line)
        for output in row.outputs:
            if output.reason(s) is not None:
                self._refused(row, s, entry, output, place)
        return answer

    def _refused(self, row: Row, s: PointSet, entry: Entry, output: Output, place: Path) -> None:
        """What has no meaning is refused in a line, and nothing is left."""
        cell = f"program/{row.name}/{REFERENCE}/{s.name}/{output.name}"
        self.cells.no_meaning(cell, output.reason(s) or "")
        path = place / f"refused{output.ending}"
        ran = self.run(
            self._line(row, s, entry, [w.format(path) for w in output.words]), entry.stdin
        )
        fault = None
        if ran.status not in (1, 2) or path.exists():
            fault = f"has no meaning ({output.reason(s)}), but ended with {ran.status}"
        elif len(ran.err.splitlines()) != 1:
            fault = f"refused in {len(ran.err.splitlines())} lines: {ran.err[:200]!r}"
        self.cells.judge(cell + " refused", fault, ran.line)

    def _unreadable(
        self, row: Row, s: PointSet, output: Output, written: dict[str, bytes]
    ) -> Optional[str]:
        if output.name not in written:
            return None
        data = written[output.name]
        try:
            corners = output.read(data)
        except Exception as error:  # whatever a reader finds
            return f"cannot be read: {type(error).__name__}: {error}"
        if output.schema is not None:
            fault = fault_of(
                self.schema, output.schema, corners if output.alike == "report" else data
            )
            if fault:
                return f"not by the schema: {fault}"
        if isinstance(corners, np.ndarray) and corners.size:
            return _coordinates(corners, s, output)
        return None

    def _try_door(self, row: Row, door: Door, s: PointSet, folder: Path, reference: Answer) -> None:
        start = f"program/{row.name}/{door.name}/{s.name}"
        asked = [o for o in row.outputs if o.reason(s) is None]
        reason = self._without(row, door) or door.reason(s)
        if reason is not None:
            for output in asked:
                self.cells.no_meaning(f"{start}/{output.name}", reason)
            return
        if not self._tried(row, door.name, s):
            return
        place = folder / door.name
        place.mkdir(exist_ok=True)
        entry = self._enter(row, door, s, place)
        if door.refuses(s) is not None:
            self._refused_door(start, row, s, entry, asked, place, door.refuses(s) or "")
            return
        pages = [o for o in asked if o.alike == "page" and door.scalar != "f64"]
        for output in pages:
            self.cells.no_meaning(
                f"{start}/{output.name}", "a page holds numbers as they were read"
            )
        if not pages:
            self._compare(start, row, s, entry, asked, place, reference, door)

    def _refused_door(
        self,
        start: str,
        row: Row,
        s: PointSet,
        entry: Entry,
        asked: list[Output],
        place: Path,
        why: str,
    ) -> None:
        for output in asked:
            self.cells.no_meaning(f"{start}/{output.name}", why)
        ran, _ = self._ask(row, s, entry, asked, place, {})
        refused = ran.status == 1 and len(ran.err.splitlines()) == 1
        self.cells.judge(
            f"{start}/refused", None if refused else f"{why}: but ended with {ran.status}", ran.line
        )

    def _tried(self, row: Row, door: str, s: PointSet) -> bool:
        """Whether a run of this length has the triple."""
        if self.large or row.doors == "every" or s.kind == "decimal":
            return True
        few = door in FEW_DOORS, s.name in FEW_SETS
        return all(few) if row.doors == "main" else any(few)

    def _try_ways(self, row: Row, s: PointSet, folder: Path, reference: Answer) -> None:
        """Options that change nothing: each by the reference door."""
        if row.doors == "main" or not self._tried(row, "", s):
            return
        asked = [o for o in row.outputs if o.reason(s) is None]
        door = next(d for d in DOORS if d.name == REFERENCE)
        place = folder / "ways"
        place.mkdir(exist_ok=True)
        entry = self._enter(row, door, s, place)
        for option, value in WAYS:
            start = f"program/{row.name}/{option} {value}/{s.name}"
            if option not in self.options_of(row.words[0]):
                self.cells.no_meaning(start, f"{row.words[0]} has no {option}")
                continue
            if option in row.ways:
                self.cells.no_meaning(start, row.ways[option])
                continue
            way = Entry(entry.words, [*entry.options, option, value], entry.stdin)
            self._compare(
                start,
                row,
                s,
                way,
                asked,
                place,
                reference,
                replace(door, blocks=option in ("--stream", "--cull")),
            )

    def _compare(
        self,
        start: str,
        row: Row,
        s: PointSet,
        entry: Entry,
        asked: list[Output],
        place: Path,
        reference: Answer,
        door: Door,
    ) -> None:
        if not asked or not self.cells.wanted(start):
            return
        written: dict[str, bytes] = {}
        ran, fault = self._ask(row, s, entry, asked, place, written)
        if fault is None and not s.finite and row.not_finite:
            fault = _same_complaint(ran.err, reference.error)
        for output in asked:
            found = fault
            if found is None and output.name in written:
                if output.name not in reference.written:
                    found = "the reference door has no answer"
                else:
                    try:
                        found = self._difference(
                            s, output, written[output.name], reference.written[output.name], door
                        )
                    except Exception as error:  # whatever a reader finds
                        found = f"cannot be read: {type(error).__name__}: {error}"
            line = f"{ran.line}\n    reference: {reference.line}" if found else ""
            self.cells.judge(f"{start}/{output.name}", found, line)

    def _difference(
        self, s: PointSet, output: Output, got: bytes, want: bytes, door: Door
    ) -> Optional[str]:
        fault = difference(output, got, want, door.exact == "exact", s.points)
        if fault is None or output.alike != "survivors" or not door.blocks:
            return fault
        return self._lost(s, output, got)

    def _lost(self, s: PointSet, output: Output, got: bytes) -> Optional[str]:
        """Of the filter in blocks, or by another method: whether an extreme point is missing."""
        found = output.read(got)
        hull = json.loads(self._hull(s).read_text())
        if found is not None and found.ndim == 1:
            lost = set(hull["vertices"]) - set(found.tolist())
        else:
            rows = [] if found is None else (found[:, : s.dimension] + 0.0).tolist()
            lost = {tuple(v) for v in hull["vertex_coordinates"]} - {tuple(row) for row in rows}
        return f"without the extreme point {min(lost)}" if lost else None

    # Command lines

    def _without(self, row: Row, door: Door) -> Optional[str]:
        if row.shape == "sequence" and not door.single and door not in SEQUENCES:
            return row.without["several"]
        if row.scalars not in (None, door.scalar):
            return "the hull names the scalar type of its points, and certify compares it"
        for key in (door.name, *sorted(door.options)):
            if key in row.without:
                return row.without[key]
        if not door.single and "several" in row.without:
            return row.without["several"]
        if row.shape == "sequence" and door.name.startswith("pipe"):
            return row.without["pipe"]
        return None

    def _enter(self, row: Row, door: Door, s: PointSet, place: Path) -> Entry:
        if row.shape != "sequence" or door in SEQUENCES:
            return door.enter(place, s)
        words = []
        for i, frame in enumerate((s, PointSet(s.kind, s.points[::-1].copy(), _turned(s.grid)))):
            (place / f"frame-{i}").mkdir(exist_ok=True)
            words += door.enter(place / f"frame-{i}", frame).words
        return Entry(words, [])

    def _ask(
        self,
        row: Row,
        s: PointSet,
        entry: Entry,
        asked: list[Output],
        place: Path,
        written: dict[str, bytes],
    ) -> tuple[Ran, Optional[str]]:
        """Runs a row once for all outputs; what was written, or why none of them holds."""
        paths, words = {}, []
        for i, o in enumerate(asked):
            of_frames = row.shape == "sequence" and o.words[0] == "-o"
            stem = str(place / f"out{i}") + ("-{}" if of_frames else "")
            words += [w.format(f"{stem}{o.ending}".format("%d")) for w in o.words]
            if o.ending:
                paths[o.name] = Path(f"{stem}{o.ending}".format(1))  # the second frame
                paths[o.name].unlink(missing_ok=True)
        ran = self.run(self._line(row, s, entry, words), entry.stdin, place)
        want = 0 if s.finite else row.not_finite
        if ran.status == 3 and "qhull returned" in ran.err:
            return ran, None  # Qhull's own facets were wrong, and are refused
        if ran.status != want:
            return ran, f"status {ran.status}, not {want}: {ran.err.strip()[-300:]}"
        left = [p for p in paths.values() if p.exists()]
        if want:
            if left:
                return ran, f"refused, but {left[0].name} was written"
            # A remark on the columns of a text may stand before the error.
            errors = [e for e in ran.err.splitlines() if " taken as coordinates" not in e]
            if len(errors) != 1 or not _POINT.search(errors[0]):
                return ran, f"says {ran.err[:200]!r}, which names no point"
            return ran, None
        for output in asked:
            if output.ending:
                if not paths[output.name].exists():
                    return ran, f"{paths[output.name].name} was not written"
                written[output.name] = paths[output.name].read_bytes()
            else:  # texts come one after another, and are compared as one
                written[output.name] = ran.out
        return ran, None

    def _line(self, row: Row, s: PointSet, entry: Entry, outputs: list[str]) -> list[str]:
        command, *said = (w.format(box=_box(s)) for w in row.words)
        extra = self._extra(row, s)
        if row.shape == "qconvex":
            named = [] if entry.stdin is not None else ["TI", *entry.words]
            return [command, *said, *named, *entry.options, *outputs]
        last = []
        if row.shape == "with reference":
            last = [str(self._hull(s))]
        elif row.shape == "with hull":
            last = [str(self._own_hull(s, entry))]
        return [command, *entry.words, *last, *said, *entry.options, *extra, *outputs]

    def _hull(self, s: PointSet) -> Path:
        folder = self.folder / s.name
        with self.lock:
            if not (folder / "hull.json").exists():
                (folder / "points.npy").write_bytes(files.npy(s.points))
                self.run(
                    ["hull", str(folder / "points.npy"), "-q", "-o", str(folder / "hull.json")]
                )
        return folder / "hull.json"

    def _own_hull(self, s: PointSet, entry: Entry) -> Path:
        hull = self.folder / s.name / f"{threading.get_ident()}.json"
        self.run(["hull", *entry.words, *entry.options, "-q", "-o", str(hull)], entry.stdin)
        return hull

    def _extra(self, row: Row, s: PointSet) -> list[str]:
        if row.extra is None:
            return []
        if row.extra == "clip":
            path = self.folder / s.name / "clip.geojson"
            path.write_text(_dented(s))
            return ["--clip", str(path)]
        path = self.folder / s.name / f"{row.extra}.npy"
        if not path.exists():
            values = (
                np.arange(s.count) % 5 / 8.0
                if row.extra == "weights"
                else np.array([[0, 1], [2, 3]])
            )
            path.write_bytes(files.npy(values))
        return [f"--{row.extra}", str(path)]


def _turned(grid: Any) -> Any:
    return None if grid is None else (grid[0][::-1], grid[1], grid[2])


def _dented(s: PointSet) -> str:
    """GeoJSON: the box around all points, whose upper side is drawn in to its middle."""
    low, high = np.array(_box(s).split(","), dtype=float).reshape(2, -1)
    middle = ((low + high) / 2).tolist()
    x, y = (low[0], high[0]), (low[1], high[1])
    ring = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], middle[:2], [x[0], y[1]], [x[0], y[0]]]
    return json.dumps({"type": "Polygon", "coordinates": [ring]})


def _box(s: PointSet) -> str:
    """Around all points, wider than their own box."""
    if not s.count or not s.finite:
        low, high = np.zeros(s.dimension), np.ones(s.dimension)
    else:
        low, high = s.points.min(axis=0), s.points.max(axis=0)
    margin = float((high / 2 - low / 2).max()) or 1.0
    return ",".join(repr(float(x)) for x in (*(low - margin), *(high + margin)))


def _same_complaint(got: str, want: str) -> Optional[str]:
    a, b = _POINT.search(got), _POINT.search(want)
    if a and b and a[0] == b[0]:
        return None
    return f"says {got.strip()[-160:]!r}, by the reference {want.strip()[-160:]!r}"


def _coordinates(corners: Any, s: PointSet, output: Output) -> Optional[str]:
    if s.finite and not np.isfinite(corners).all():
        return "coordinates that are not finite"
    if not output.of_points or corners.ndim != 2:
        return None
    given = s.points
    if corners.shape[1] == 3 and s.dimension == 2:
        given = np.column_stack([given, np.zeros(s.count)])
    elif corners.shape[1] > s.dimension:
        given = np.column_stack([given, np.zeros((s.count, corners.shape[1] - s.dimension))])
    known = {(row + 0.0).tobytes() for row in given}
    stranger = next((row for row in corners if (row + 0.0).tobytes() not in known), None)
    return None if stranger is None else f"holds {stranger.tolist()}, which is none of the points"
