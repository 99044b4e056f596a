"""What the program says about itself, held against the table: a command, an option, a format or an
ending that the program knows and the table does not fails the test."""

from __future__ import annotations

import re
from typing import Optional

from commands import OPTIONS_ELSEWHERE, ROWS, WAYS, WITHOUT_POINTS
from doors import DOORS, ELSEWHERE
from program import Program


def all_cells(program: Program) -> None:
    commands = _commands(program)
    covered = {row.words[0] for row in ROWS} | set(WITHOUT_POINTS)
    for command in commands:
        judge(
            program,
            f"commands/{command}",
            None if command in covered else f"{command} has no row in commands.py",
            "--help",
        )
    for command in sorted(covered - set(commands)):
        judge(program, f"commands/{command}", f"there is no command {command}", "--help")
    for command, why in WITHOUT_POINTS.items():
        program.cells.no_meaning(f"program/{command}", why)
    for command in commands:
        _options(program, command)
    _endings(program)
    _inputs(program)


def judge(program: Program, cell: str, fault: Optional[str], *words: str) -> None:
    program.cells.judge(f"program names/{cell}", fault, " ".join([program.path, *words]))


def _commands(program: Program) -> list[str]:
    listed = program.help_of("").split("Subcommands:")[1].split("\n\n")[0]
    return re.findall(r"^  (\w[\w-]*) ", listed, re.M)


def _options(program: Program, command: str) -> None:
    of_rows = {
        word
        for row in ROWS
        if row.words[0] == command
        for word in (
            *row.words,
            *(w for o in row.outputs for w in o.words),
            *([f"--{row.extra}"] if row.extra else []),
        )
    }
    known = {word.split("=")[0] for word in of_rows} | {"--output"}
    if command == "generate":
        known |= {"--json", "--type", "--dim"}  # across.py
    known |= {option for door in DOORS for option in door.options} | {option for option, _ in WAYS}
    for option in sorted(program.options_of(command)):
        if option in OPTIONS_ELSEWHERE:
            program.cells.no_meaning(f"program names/{command} {option}", OPTIONS_ELSEWHERE[option])
            continue
        fault = None if option in known else "is in no row, no door, no way"
        judge(program, f"options/{command} {option}", fault, command, "--help")


#: Options that write files: what the row's words say before the name, and the command line that
#: makes the program list the endings it takes.
_WRITING = (
    ("hull", "-o"),
    ("hull", "--vertices"),
    ("hull", "--partial"),
    ("cull", "-o"),
    ("cull", "--points"),
    ("delaunay", "-o"),
    ("voronoi", "-o"),
    ("voronoi", "--measures"),
    ("alpha", "-o"),
    ("view", "-o"),
)
#: Endings that need another input than the doors give.
_OTHER_ENDINGS = {
    ".hullstate": "a binary state: .npz holds the same arrays",
    ".las": "copies records of one .las: cli_cull_test and foreign_files",
    ".htm": "the same as .html",
}


def _endings(program: Program) -> None:
    points = program.folder / "endings.xyz"
    points.write_text("0 0\n1 0\n0 1\n")
    for command, option in _WRITING:
        said = program.run(
            [command, str(points), "-q", option, str(program.folder / "x.unknown")]
        ).err
        listed = re.findall(r"\.\w+", said.split("must end in")[-1])
        held = {
            o.ending
            for row in ROWS
            if row.words[0] == command
            for o in row.outputs
            if o.words[0] == option
        }
        judge(
            program,
            f"endings/{command} {option}",
            None if listed else f"lists none: {said!r}",
            command,
            option,
        )
        for ending in listed:
            if ending in _OTHER_ENDINGS:
                program.cells.no_meaning(
                    f"program names/{command} {option} {ending}", _OTHER_ENDINGS[ending]
                )
                continue
            judge(
                program,
                f"endings/{command} {option} {ending}",
                None if ending in held else "no row writes it",
                command,
                option,
            )


def _inputs(program: Program) -> None:
    words = re.search(r"--input-format ([\w|]+)", program.help_of("hull"))
    names = words[1].split("|") if words else []
    listed = program.run(["help", "formats"]).out.decode().split("\n\nSeveral inputs")[0]
    endings = set(re.findall(r"(?<![\w}])\.[a-z]\w*", listed))
    doors = {door.name for door in DOORS}
    for name in names or [""]:
        fault = None if name in doors else "no door of doors.py has the format"
        if f".{name}" not in endings:
            fault = "is not in help formats"
        judge(program, f"inputs/{name}", fault, "hull --help")
    held = " ".join([*(f".{name}" for name in names), ".gz .zst .npz", *ELSEWHERE])
    for ending in sorted(endings):
        fault = None if ending in held.split() else "neither a door of doors.py nor in ELSEWHERE"
        judge(program, f"inputs/{ending}", fault, "help formats")
