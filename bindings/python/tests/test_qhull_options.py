"""Every option that Qhull documents: what becomes of it, and that the answers are as SciPy's."""

import re
import warnings
from pathlib import Path

import numpy as np
import pytest

import cullhull
from cullhull.scipy._qhull_options import TABLE, Kind, kind_of, parse

spatial = pytest.importorskip("scipy.spatial")

#: What `qhull -` lists, by its own headings, each with a number where it wants one.
DOCUMENTED = (
    # options and control
    *("d", "v", "H0,0", "Qc", "Qi", "QJ", "Qt", "Qa", "Qb0:1", "QB0:1", "QbB", "Qbb", "Qb1:0B1:0"),
    *("QJ1e-9", "QR0", "QR-1", "Qs", "Qu", "QV3", "QV-3", "Qx", "Qz"),
    # extra
    *("Qf", "Qg", "QG3", "QG-3", "Qm", "Qr", "Qv", "Qw", *(f"Q{i}" for i in range(16))),
    # T and trace
    *("TF10", "TI", "TO", "Ts", "Tv", "Tz", "T4", "T-1", "Ta", "TA5", "TC5", "TV5", "TV-5", "Tc"),
    *("Tf", "TP5", "TP-1", "TM3", "TW1", "TR2"),
    # precision
    *("C-0", "C0.01", "C-0.01", "A-0.99", "A0.99", "E1e-12", "R1e-9", "V1e-9", "U1e-9", "W1e-9"),
    # formats
    *"f G i m n o p s Fa FA Fc FC Fd FD FF Fi FI Fm FM Fn FN Fo FO Fp FP FQ Fs FS Ft Fv FV".split(),
    *"Fx Ga Gp Gv Gc GD1 Gh Gi Gn Go Gr Gt".split(),
    # print
    *("PA3", "Pd0", "Pd0:0.5", "PD1", "PD1:0.5", "PF1", "PF0.5", "Pg", "PG", "PM2", "Po", "Pp"),
)

POINTS = cullhull.generate("ball", 60, 3)
EXPECTED = cullhull.ConvexHull(POINTS)


def by_kind(kind):
    return [option for option in DOCUMENTED if kind_of(option)[0] is kind]


def rows(hull):
    return {frozenset(row): tuple(plane) for row, plane in zip(hull.simplices.tolist(), hull.equations)}


def test_each_has_its_kind():
    counts = {kind: len(by_kind(kind)) for kind in Kind}
    assert sum(counts.values()) == len(DOCUMENTED) == len(set(DOCUMENTED))
    assert counts[Kind.works] == 4 and counts[Kind.refused] < 20
    for pattern, _, _ in TABLE:
        assert any(re.fullmatch(pattern, option) for option in DOCUMENTED) or pattern == "QV.*"


def test_the_documentation_names_each():
    page = (Path(__file__).parents[3] / "docs" / "python.md").read_text("utf-8")
    named = set(re.findall(r"`([^` ]+)`", page))
    families = {name[:-1] for name in named if name.endswith("…")}
    for option in DOCUMENTED:
        name = re.sub(r"(?<=[A-Za-z])-?[\d.]+(e-?\d+)?$", "n", option)  # QG3: QGn
        name = re.sub(r"^(Q[bB]|P[dD])\d+$|^(Q[bB]|P[dD])\d+:.*[^0]$|^Pdn$|^PDn$", lambda m: "", name)
        known = named | {"QG-n", "QV-n", "Hn"}
        assert (
            name in known
            or option in known
            or any(option.startswith(family) for family in families)
            or re.match(r"Q\d+$|Q[bB]\d|P[dD]\d|H|C-|A-|T-|TP-|TV-|QR-|QG-|QV-", option)
        ), option


@pytest.mark.parametrize("option", by_kind(Kind.silent))
@pytest.mark.filterwarnings("error")
def test_silent(option):
    ours = cullhull.ConvexHull(POINTS, qhull_options=option)
    assert rows(ours) == rows(EXPECTED) and ours.volume == EXPECTED.volume
    try:
        theirs = spatial.ConvexHull(POINTS.copy(), qhull_options=option)
    except spatial.QhullError:
        return  # one that SciPy's Qhull does not know, or has no use for
    other = rows(theirs)
    assert set(other) == set(rows(ours))
    assert all(np.allclose(other[row], plane) for row, plane in rows(ours).items())
    assert np.isclose(theirs.volume, ours.volume) and np.isclose(theirs.area, ours.area)


@pytest.mark.parametrize("option", by_kind(Kind.warned))
def test_warned(option):
    with pytest.warns(cullhull.OptionWarning, match=re.escape(repr(option))) as told:
        ours = cullhull.ConvexHull(POINTS, qhull_options=f"Qt {option} Pp")
    assert len(told) == 1 and told[0].filename == __file__
    assert rows(ours) == rows(EXPECTED) and ours.volume == EXPECTED.volume
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", cullhull.OptionWarning)
        cullhull.ConvexHull(POINTS, qhull_options=option)


def test_one_warning_a_call():
    with pytest.warns(cullhull.OptionWarning) as told:
        cullhull.ConvexHull(POINTS, qhull_options="QJ QbB Qm E1e-9")
    assert len(told) == 1
    for option in ("QJ", "QbB", "Qm", "E1e-9"):
        assert repr(option) in str(told[0].message)
    with pytest.warns(cullhull.OptionWarning) as told:
        for _ in range(3):
            cullhull.HalfspaceIntersection([[1, 0, -1], [0, 1, -1], [-1, -1, -1]], qhull_options="QJ")
    assert len(told) == 3  # what is shown once is for Python's filters to say


@pytest.mark.parametrize("option", by_kind(Kind.refused))
def test_refused(option):
    with pytest.raises(ValueError, match=re.escape(option)):
        cullhull.ConvexHull(POINTS, qhull_options="Qt " + option)


def test_unknown():
    for option in ("Q", "Qy", "hello", "QG", "QGx", "QG--1", "PP", "C1x", "-", "QJx", "E", "Q20"):
        with pytest.raises(ValueError, match=re.escape(option)):
            cullhull.ConvexHull(POINTS, qhull_options="Qt " + option)
    for wrong in (3, ["Qt"]):
        with pytest.raises(TypeError):
            cullhull.ConvexHull(POINTS, qhull_options=wrong)
    assert parse("") == parse(None) == parse(b"Qt")


@pytest.mark.filterwarnings("ignore::cullhull.OptionWarning")
def test_joggled_programs_get_an_answer():
    """What public programs do: QJ at once, or after an error, or inside `except Exception`."""
    assert np.isclose(
        cullhull.ConvexHull(POINTS, qhull_options="QJ").volume,
        spatial.ConvexHull(POINTS, qhull_options="QJ").volume,
    )
    flat = np.column_stack([POINTS[:, :2], np.zeros(60)])
    assert spatial.ConvexHull(flat, qhull_options="QJ").volume < 1e-6
    for strict in (False, True):
        hull = cullhull.ConvexHull(flat, qhull_options="QJ", strict=strict)
        assert hull.hull.affine_dimension == 2
    grid = np.indices((3, 3, 3)).reshape(3, -1).T
    assert cullhull.ConvexHull(grid, qhull_options="QJ Pp").volume == 8
