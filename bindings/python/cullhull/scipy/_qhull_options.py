"""Qhull's option strings, as far as they mean something for an exact hull."""

from __future__ import annotations

import re
from enum import Enum
from typing import NamedTuple

from .._errors import InvalidArgument, OptionWarning, warn


class QhullOptions(NamedTuple):
    """What an option string asks of the result; all the rest of it steers Qhull's precision."""

    #: Qc: list points on the boundary that are no vertices.
    coplanar: bool = False
    #: Qi: list points strictly inside.
    interior: bool = False
    #: QGn, QG-n: leave point n out and mark the facets visible, or not visible, from it.
    good_point: int | None = None
    good_if_visible: bool = True
    #: QJ: flat input is no error, not even where it is in SciPy.
    joggled: bool = False
    #: Qbb: the last coordinate, which of a triangulation is the lifted one, is scaled.
    scaled_last: bool = False
    #: Qz: a point at infinity takes part; Qhull's default for triangulations that do not grow.
    at_infinity: bool = False


NOTHING = QhullOptions()


class Kind(Enum):
    """What becomes of an option."""

    works = "works as in Qhull"
    silent = "accepted: the result has what it asks for, or never depends on it"
    warned = "accepted with an OptionWarning: it has no effect here"
    refused = "raises ValueError: the answer would be another"


_NUMBER = r"-?\d+(\.\d*)?([eE][-+]?\d+)?"

#: Every option that Qhull documents: pattern, what becomes of it, why. The first that fits counts.
TABLE: tuple[tuple[str, Kind, str], ...] = (
    ("Qc|Qi", Kind.works, "lists points in `coplanar`"),
    (r"QG-?\d+", Kind.works, "marks `good` simplices"),
    ("Qt", Kind.silent, "simplices are what one always gets"),
    ("Qx|Q([0-9]|1[0-9])|C-0", Kind.silent, "steers the merging that rounding makes necessary"),
    ("Q[rfsvwa]", Kind.silent, "steers the order of the work or the checks of the options"),
    ("P[po]", Kind.silent, "hides precision problems, of which there are none"),
    (f"T([acfsvz]|-?\\d+|F\\d+|[PRW]{_NUMBER}|M\\d+)", Kind.silent, "traces, counts or checks"),
    (
        f"QJ({_NUMBER})?",
        Kind.warned,
        "joggles the input; no joggling is needed: the result is exact, the hull of the points as "
        "they are",
    ),
    (
        "QbB|Qbb",
        Kind.warned,
        "scales the input against rounding; here `equations`, `area` and `volume` are those of "
        "the points as they are",
    ),
    (
        f"QR{_NUMBER}",
        Kind.warned,
        "rotates the input to try other roundings; here `equations` are those of the points as "
        "they are",
    ),
    (
        f"C-?({_NUMBER})?|[AERUVW]{_NUMBER}",
        Kind.warned,
        "sets a tolerance; here there is none, and no facet is merged or moved",
    ),
    ("Qm", Kind.warned, "skips points within a tolerance; here there is none"),
    (
        r"QV-?\d+|Pg|PG|P[AMF]\d*(\.\d*)?|P[dD]\d+(:.+)?",
        Kind.warned,
        "selects facets to print; here, as in SciPy, nothing is printed",
    ),
    (
        "[fimnopsG]|F[a-zA-Z]|G[a-zA-Z]+\\d*",
        Kind.warned,
        "is a format to print; here, as in SciPy, nothing is printed (python -m cullhull hull "
        "--format prints)",
    ),
    ("Qg", Kind.refused, "builds only part of the hull; QGn marks the facets seen instead"),
    ("Q[uz]", Kind.refused, "is for Delaunay triangulations"),
    (r"QV.*", Kind.refused, "needs a point's number: QVn"),
    (r"Q[bB]\d+.*", Kind.refused, "scales or drops a coordinate; change the array instead"),
    (r"T[ACV].*", Kind.refused, "stops before the hull is whole"),
    ("T[IO].*", Kind.refused, "reads or writes a file"),
    ("[dv]|H.*", Kind.refused, "asks for something else than a hull"),
)

#: What Delaunay and Voronoi make of some of them; of all others the same.
LIFTED_TABLE: tuple[tuple[str, Kind, str], ...] = (
    ("Qc", Kind.works, "lists duplicates in `coplanar`"),
    ("Qbb", Kind.works, "scales the lifted coordinate of `equations`"),
    ("Qz", Kind.works, "adds a point at infinity, which is needed for rounding's sake alone"),
    ("Qi|[dv]", Kind.silent, "asks for what one always gets"),
    (
        f"QJ({_NUMBER})?",
        Kind.warned,
        "joggles the input; no joggling is needed: the result is exact, the triangulation of the "
        "points as they are: equal points share a vertex, and flat ones are triangulated in their "
        "flat",
    ),
    (
        "QbB",
        Kind.warned,
        "scales the input against rounding; here `equations` are those of the points as they are",
    ),
    (r"QG-?\d+", Kind.refused, "leaves a point out; leave it out of the array instead"),
    ("Qu", Kind.refused, "asks for the furthest-site diagram; pass furthest_site=True instead"),
)

_TABLE = [(re.compile(pattern), kind, why) for pattern, kind, why in TABLE]
_LIFTED_TABLE = [(re.compile(pattern), kind, why) for pattern, kind, why in LIFTED_TABLE]


def parse(options: str | bytes | None, *, lifted: bool = False) -> QhullOptions:
    """Reads an option string as SciPy takes it, with one OptionWarning for what has no effect.

    `lifted`: for a triangulation or a diagram, not a hull. Raises InvalidArgument for what would
    change the answer, and for unknown options.
    """
    if options is None:
        return NOTHING
    if isinstance(options, bytes):
        options = options.decode("latin1")
    if not isinstance(options, str):
        raise TypeError(f"qhull_options must be a string, not {type(options).__name__}")
    found = NOTHING
    without_effect = []
    for word in options.split():
        kind, why = kind_of(word, lifted=lifted)
        if kind is Kind.refused:
            raise InvalidArgument(f"Qhull option {word!r} is not supported: it {why}")
        if kind is Kind.warned:
            without_effect.append(f"{word!r} {why}")
        if kind is Kind.works or word.startswith("QJ"):
            found = _with(found, word)
    if without_effect:
        warn(f"Qhull option without effect: {'; '.join(without_effect)}", OptionWarning)
    return found


def kind_of(word: str, *, lifted: bool = False) -> tuple[Kind, str]:
    """What becomes of one option, and why. Raises InvalidArgument for unknown ones."""
    for pattern, kind, why in [*_LIFTED_TABLE, *_TABLE] if lifted else _TABLE:
        if pattern.fullmatch(word):
            return kind, why
    raise InvalidArgument(f"Qhull option {word!r} is unknown")


def _with(options: QhullOptions, word: str) -> QhullOptions:
    if word == "Qc":
        return options._replace(coplanar=True)
    if word == "Qi":
        return options._replace(interior=True)
    if word.startswith("QJ"):
        return options._replace(joggled=True)
    if word == "Qbb":
        return options._replace(scaled_last=True)
    if word == "Qz":
        return options._replace(at_infinity=True)
    return options._replace(good_point=int(word[2:].lstrip("-")), good_if_visible="-" not in word)
