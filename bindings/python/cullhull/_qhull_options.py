"""Qhull's option strings, as far as they mean something for an exact hull."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ._errors import InvalidArgument


@dataclass(frozen=True)
class QhullOptions:
    """What an option string asks of the result; all the rest of it steers Qhull's precision."""

    #: Qc: list points on the boundary that are no vertices.
    coplanar: bool = False
    #: Qi: list points strictly inside.
    interior: bool = False
    #: QGn, QG-n: leave point n out and mark the facets it sees, or does not see.
    good_point: int | None = None
    good_if_visible: bool = True


_NUMBER = r"-?\d+(\.\d*)?([eE][-+]?\d+)?"

# Without effect here, because they change how Qhull computes and rounds, not what it means to
# compute: each with what it does there.
_NO_EFFECT = re.compile(
    "|".join(
        [
            "Qt",  # triangulate facets: simplices always are
            "Qx|Qs|Qf|Qv|Qw|Qa",  # merging, first simplex, order of work, allowed warnings
            "Qbb|QbB",  # scale the input while computing; our coordinates stay the caller's
            "Q([0-9]|1[0-9])",  # Q0 to Q19: merging and searching in detail
            f"C-?({_NUMBER})?",  # merge almost coplanar facets
            f"[AERUVW]({_NUMBER})",  # tolerances: angle, distance, perturbation, visibility, width
            "Pp|PF?",  # no precision warnings
            "T[cs]|Tv|T-?\\d+",  # checking, statistics, tracing
        ]
    )
)

_REFUSED = {
    "QJ": "joggles the input; results here are exact, with any input, and simplicial as they are",
    "Qu": "asks for an upper Delaunay hull",
    "Qz": "adds a point at infinity",
    "Qg": "builds only part of the hull; QGn marks the facets seen instead",
    "Qm": "leaves points out",
    "Qr": "builds the hull in random order without its precision handling",
    "QV": "selects the facets at a point; compare `simplices` with it instead",
    "QR": "rotates the input and reports rotated planes",
    "Qb": "scales or drops a coordinate; change the array instead",
    "QB": "scales a coordinate; change the array instead",
    "Pd": "drops facets from the output",
    "PD": "drops facets from the output",
    "PG": "drops facets from the output",
    "F": "asks for printed output, which the command line has (python -m cullhull hull --format)",
}


def parse(options: str | bytes | None) -> QhullOptions:
    """Reads an option string as SciPy takes it. Raises InvalidArgument for what would change the
    result in a way that is not supported, and for unknown options."""
    if options is None:
        return QhullOptions()
    if isinstance(options, bytes):
        options = options.decode("latin1")
    if not isinstance(options, str):
        raise TypeError(f"qhull_options must be a string, not {type(options).__name__}")
    coplanar = interior = False
    good_point: int | None = None
    visible = True
    for word in options.split():
        good = re.fullmatch(r"QG(-?)(\d+)", word)
        if word == "Qc":
            coplanar = True
        elif word == "Qi":
            interior = True
        elif good:
            visible, good_point = good[1] == "", int(good[2])
        elif not _NO_EFFECT.fullmatch(word):
            raise InvalidArgument(f"Qhull option {word!r} {_reason(word)}")
    return QhullOptions(coplanar, interior, good_point, visible)


def _reason(word: str) -> str:
    for start, reason in _REFUSED.items():
        if word.startswith(start):
            return f"is not supported: it {reason}"
    return "is unknown"
