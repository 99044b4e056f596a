"""cullhull-mpi beside cullhull: the same files, statuses and lines; and what ends a job.

Usage: cullhull_mpi_test.py CULLHULL CULLHULL_MPI FOLDER LAUNCHER...
"""

import os
import signal
import subprocess
import sys
import time
import unittest

CULLHULL, CULLHULL_MPI, FOLDER = sys.argv[1:4]
LAUNCHER = sys.argv[4:]


def path(name):
    return os.path.join(FOLDER, name)


def alone(*words):
    return subprocess.run([CULLHULL, *words], capture_output=True, text=True, timeout=120)


def on_ranks(ranks, *words):
    command = [*LAUNCHER, "-n", str(ranks), CULLHULL_MPI, *words]
    return subprocess.run(command, capture_output=True, text=True, timeout=120)


def ours(text):
    """The lines that are not the launcher's."""
    return [line for line in text.splitlines() if line.startswith("cullhull: ")]


def make(shape, count, dimension, name):
    points = path(shape + ".npy")
    made = alone("generate", shape, "-n", str(count), "-d", str(dimension), "-o", points, "-q")
    assert made.returncode == 0, made.stderr
    if name.endswith(".npy"):
        os.replace(points, path(name))
    else:
        made = alone("cull", points, "--cull", "none", "--points", path(name), "-q")
        assert made.returncode == 0, made.stderr
    return path(name)


def ranks_of(launcher):
    """Processes of the program below the launcher."""
    found = []
    for entry in os.listdir("/proc"):
        try:
            with open(f"/proc/{entry}/stat") as stat:
                text = stat.read()
            parent = int(text.rsplit(")", 1)[1].split()[1])
            if parent == launcher and os.readlink(f"/proc/{entry}/exe") == os.path.realpath(CULLHULL_MPI):
                found.append(int(entry))
        except (OSError, IndexError, ValueError):
            pass
    return found


class Same(unittest.TestCase):
    def check(self, ranks, *files):
        for ending in ("json", "ply"):
            one = alone("hull", *files, "--stream", "on", "-o", path("one." + ending), "-q")
            self.assertEqual(one.returncode, 0, one.stderr)
            many = on_ranks(ranks, "hull", *files, "-o", path("many." + ending), "--certify")
            self.assertEqual(many.returncode, 0, many.stderr)
            self.assertIn("certified  yes", many.stdout)
            self.assertEqual(many.stdout.count("vertices"), 1, many.stdout)
            with open(path("one." + ending), "rb") as a, open(path("many." + ending), "rb") as b:
                self.assertEqual(a.read(), b.read())

    def test_slices_of_one_file(self):
        self.check(4, make("ball", 50001, 3, "slices.npy"))

    def test_slices_of_ply(self):
        self.check(3, make("ball", 50000, 3, "slices.ply"))

    def test_text_and_binary(self):
        files = [make("gauss", 500, 3, "a.csv"), make("ball", 4000, 3, "b.npy"),
                 make("cube", 3, 3, "c.xyz")]
        self.check(2, *files)
        self.check(5, *files)

    def test_whole_tiles(self):
        self.check(2, *[make("ball", 100 * k, 3, f"tile{k}.npy") for k in range(1, 12)])

    def test_more_ranks_than_points(self):
        self.check(6, make("cube", 3, 3, "few.npy"))

    def test_raw_and_columns(self):
        raw = path("points.raw")
        with open(make("ball", 3000, 4, "four.npy"), "rb") as npy, open(raw, "wb") as out:
            out.write(npy.read()[-3000 * 32:])
        self.check(3, raw, "--input-format", "raw", "--dim", "4", "--type", "f64", "--columns",
                   "0,1,3")


class Help(unittest.TestCase):
    def test_the_program_alone_shows_its_help_once(self):
        ran = on_ranks(3)
        self.assertEqual(ran.returncode, 0, ran.stderr)
        self.assertEqual(ran.stdout.count("Usage: cullhull-mpi"), 1, ran.stdout)
        self.assertEqual(ran.stdout, on_ranks(1, "--help").stdout)
        self.assertEqual(ours(ran.stderr), [])


class Refused(unittest.TestCase):
    def check(self, status, part, *words, ranks=4):
        ran = on_ranks(ranks, *words)
        self.assertEqual(ran.returncode, status, ran.stderr)
        lines = ours(ran.stderr)
        self.assertEqual(len(lines), 1, ran.stderr)
        self.assertIn(part, lines[0])
        self.assertEqual(ran.stdout.strip(), "", ran.stdout)

    def test_not_a_number_is_named(self):
        text = path("nan.csv")
        with open(text, "w") as out:
            out.writelines("nan 0 0\n" if k == 17 else f"{k} {k * k} 1\n" for k in range(99))
        good = make("ball", 1000, 3, "good.npy")
        # The third file is that of rank 2; its first point has the id 2000.
        self.check(1, f"{text}:18: point 2017, coordinate 0 is NaN", "hull", good, good, text)
        self.check(1, f"{text}:18: point 17, ", "hull", text, text, ranks=2)
        npy = path("nan.npy")
        with open(good, "rb") as points, open(npy, "wb") as out:
            whole = points.read()
            out.write(whole[:-8 * 3 * 10] + b"\xff" * 8 + whole[-8 * 3 * 10 + 8:])
        self.check(1, f"{npy}: point 1990, coordinate 0 is NaN", "hull", good, npy)

    def test_usage_files_and_budget(self):
        good = make("ball", 1000, 3, "good.npy")
        self.check(2, "INPUT", "hull")
        self.check(2, "--repeat", "hull", good, "--repeat", "3")
        self.check(2, "must end in", "hull", good, "-o", path("hull.what"))
        self.check(1, "absent.npy", "hull", good, path("absent.npy"))
        self.check(4, "memory budget", "hull", make("sphere", 5000, 3, "s.npy"), "--memory", "2000")
        self.check(1, "no-such-folder", "hull", good, "-o", path("no-such-folder/hull.ply"))
        self.check(1, "no-such-folder", "hull", good, "-o", path("no-such-folder/hull.ply"),
                   "--certify")


class Ended(unittest.TestCase):
    """A job that takes long is ended within ten seconds, not with success."""

    def job(self, end):
        points = make("sphere", 600000, 4, "long.npy")
        command = [*LAUNCHER, "-n", "4", CULLHULL_MPI, "hull", points]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              text=True) as job:
            until = time.monotonic() + 60
            while len(ranks_of(job.pid)) < 4 and time.monotonic() < until:
                time.sleep(0.05)
            time.sleep(1)
            self.assertIsNone(job.poll(), "over before it could be ended")
            end(job)
            began = time.monotonic()
            out, err = job.communicate(timeout=60)
            self.assertLess(time.monotonic() - began, 10)
            self.assertNotEqual(job.returncode, 0, err)
            self.assertEqual(out.count("vertices"), 0)
            self.assertLessEqual(len(ours(err)), 1, err)

    def test_a_lost_rank(self):
        self.job(lambda job: os.kill(ranks_of(job.pid)[2], signal.SIGKILL))

    def test_interrupted(self):
        self.job(lambda job: job.send_signal(signal.SIGINT))

    def test_one_rank_terminated(self):
        self.job(lambda job: os.kill(ranks_of(job.pid)[1], signal.SIGTERM))


if __name__ == "__main__":
    os.makedirs(FOLDER, exist_ok=True)
    unittest.main(argv=sys.argv[:1])
