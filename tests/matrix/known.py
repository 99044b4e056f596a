"""Cells that are known to fail: names (with * for anything) and why. The list is to become empty:
an entry of which a cell passes, or that names no cell, fails the test."""

_LAS = "scale and offset of a LAS file are not applied"
_EMPTY = "points in blocks: no points have no dimension"

EXPECTED: list[tuple[str, str]] = []
