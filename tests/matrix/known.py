"""Cells that are known to fail: names (with * for anything) and why. The list is to become empty:
an entry of which no cell fails any more fails the test."""

EXPECTED: list[tuple[str, str]] = []
