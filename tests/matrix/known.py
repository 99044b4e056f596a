"""Cells that are known to fail: names (with * for anything) and why. The list is to become empty:
an entry of which no cell fails any more fails the test."""

EXPECTED: list[tuple[str, str]] = [
    ("python out/ClippedCells of */pickle/*", "no state"),
    ("python out/ClippedCells of */deepcopy/*", "no state"),
    (
        "python out/GroupHulls of hulls_by/==/*",
        "hulls are made anew at each look, and compared as objects",
    ),
    ("python/NaturalNDInterpolator itself/array/*-4d", "made, and refused when it is called"),
    ("python/griddata/dlpack/*", "SciPy's own arrays are asked first"),
    ("python/griddata/pandas-nullable/*", "SciPy's own arrays are asked first"),
    ("python/griddata/masked/*", "a mask is dropped"),
]
