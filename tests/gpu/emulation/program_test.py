#!/usr/bin/env python3
"""Files larger than the memory of the device, by the program: program_test.py PROGRAM EMULATED.

EMULATED is the program on the emulated device. Every file it writes must be that of PROGRAM.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path


def hull(program: str, points: str, folder: Path, memory: int, *options: str) -> tuple[str, bytes]:
    """Why the points were culled where they were, and the file that was written."""
    written = folder / "hull.obj"
    environment = {**os.environ, "CULLHULL_DEVICE_MEMORY": str(memory)}
    run = subprocess.run(
        [program, "hull", points, "-o", str(written), "--json", *options],
        env=environment, stdout=subprocess.PIPE, text=True, check=True,
    )
    return json.loads(run.stdout)["cull"]["reason"], written.read_bytes()


def main() -> int:
    program, emulated = sys.argv[1:]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for ending, kind, count, memory in (
            ("ply", "f32", 800_000, 8 << 20),  # the points alone take 9.6 MB
            ("npy", "f64", 400_000, 8 << 20),
        ):
            points = str(folder / f"points.{ending}")
            subprocess.run(
                [program, "generate", "ball", "-n", str(count), "--type", kind, "-q", "-o", points],
                check=True,
            )
            _, expected = hull(program, points, folder, 0, "--backend", "cpu")
            for bytes, pieces in ((memory, True), (1 << 30, False)):
                reason, found = hull(emulated, points, folder, bytes, "--backend", "cuda")
                assert "CUDA device as asked" in reason, reason
                assert ("in pieces that fit its memory" in reason) == pieces, reason
                assert found == expected, (points, bytes)
    return 0


if __name__ == "__main__":
    sys.exit(main())
