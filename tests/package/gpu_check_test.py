"""scripts/gpu-check.sh leaves its figures whatever happens: programs of a made bundle hang, crash,
skip, find no device, or are cut off. Nothing is compiled, and no device is needed."""

import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

script = Path(__file__).resolve().parents[2] / "scripts/gpu-check.sh"

# What a program of the bundle does is said by a variable of its name: STUB_gpu_passes=hang. A suite
# of gpu_tests has its own: STUB_GpuSets=skip.
stub = """#!/usr/bin/env bash
name=$(basename "$0")
does() {
  local what=STUB_$1
  case "${!what:-pass}" in
    hang) exec sleep 60 ;;
    deaf) trap '' TERM; while :; do sleep 1; done ;;
    crash) kill -SEGV $$ ;;
    skip) echo '[  SKIPPED ] something'; seq 200000 ;;
    slow) sleep 1 ;;
  esac
}
out=/dev/null
suite=
while (($#)); do
  case "$1" in
    --out) out=$2 ;;
    --gtest_list_tests)
      printf '%s.\\n  One\\n' GpuA 'GpuB/0.  # TypeParam = float' GpuLarge | sed 's/float[.]$/float/'
      exit
      ;;
    --gtest_filter=*) suite=${1#*=}; suite=${suite%.\\*}; suite=${suite%/0} ;;
    cuda) [[ -z ${STUB_no_device:-} ]] || { echo "cullhull: no driver was found" >&2; exit 5; }
          does device ;;
  esac
  shift
done
if [[ -n $suite ]]; then
  echo "$suite" >>"$STUB_calls"
  does "$suite"
  exit 0
fi
echo "{\\"part\\":\\"first of $name\\"}" >>"$out"
does "$name"
echo "{\\"part\\":\\"last of $name\\"}" >>"$out"
"""

# Runs what it is given, as compute-sanitizer does.
sanitizer = """#!/usr/bin/env bash
echo "$2" >>"$STUB_calls"
while [[ $1 == --* ]]; do [[ $1 == --tool || $1 == --error-exitcode ]] && shift; shift; done
exec "$@"
"""

smi = """#!/usr/bin/env bash
echo 'name, clocks.current.sm [MHz]'
echo 'a device, 1980 MHz'
"""

python = """#!/usr/bin/env bash
[[ -z ${STUB_python:-} ]] || echo 'SKIPPED [1] needs a device'
"""


def program(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(0o755)


class Case(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)


class Run(Case):
    def setUp(self) -> None:
        super().setUp()
        self.bundle = self.folder / "bundle"
        for name in ("cullhull", "gpu_bench", "gpu_passes", "gpu_tests"):
            program(self.bundle / "bin" / name, stub)
        program(self.bundle / "bin/scaling_bench", stub)
        program(self.bundle / "bin/cpu/twin_tests", stub)
        (self.bundle / "python").mkdir()
        (self.bundle / "about.txt").write_text("commit 1\n")
        shutil.copy(script, self.bundle)
        program(self.folder / "path/compute-sanitizer", sanitizer)
        program(self.folder / "path/nvidia-smi", smi)
        program(self.folder / "path/ncu", "#!/usr/bin/env bash\n")
        program(self.folder / "path/python3", python)
        self.calls = self.folder / "calls"
        self.results = self.bundle / "results"

    def start(self, *words: str, **does: str) -> subprocess.Popen:
        limits = {
            f"GPU_CHECK_{part}_SECONDS": "4"
            for part in ("SUITE", "SANITIZER", "PASSES", "NCU", "BENCH", "SCALING")
        }
        environment = {
            **os.environ,
            "PATH": f"{self.folder / 'path'}:{os.environ['PATH']}",
            "STUB_calls": str(self.calls),
            **limits,
            "GPU_CHECK_CHANGED_SUITES": "GpuB/0",
            **{f"STUB_{name}": what for name, what in does.items()},
        }
        self.said = self.folder / "said"
        with self.said.open("w") as said:
            return subprocess.Popen(
                [str(self.bundle / "gpu-check.sh"), "run", *words],
                env=environment, stdout=said, stderr=subprocess.STDOUT,
            )  # fmt: skip

    def run_it(self, *words: str, **does: str) -> tuple[int, str]:
        status = self.start(*words, **does).wait(timeout=120)
        return status, self.summary()

    def summary(self) -> str:
        return "".join(path.read_text() for path in sorted(self.results.glob("gpu-check-2*.txt")))

    def figures(self, kind: str) -> str:
        return "".join(path.read_text() for path in self.results.glob(f"{kind}-*.jsonl"))

    def assert_lines(self, summary: str, *lines: str) -> None:
        """Each is the beginning of a line, in this order."""
        at = 0
        for line in lines:
            found = ("\n" + summary).find("\n" + line, at)
            self.assertGreaterEqual(found, 0, f"{line!r} is missing, or too early, in\n{summary}")
            at = found + 1

    def test_both_calls_pass(self) -> None:
        status, summary = self.run_it("--call", "1")
        self.assertEqual(status, 0, self.said.read_text())
        self.assert_lines(
            summary, "cpu ", "nvidia-smi at the start: a device, 1980", "passed  gpu hull",
            "passed  gpu GpuB/0", "passed  passes", '{"part":"last of gpu_passes"}', "passed  ncu",
            "passed  hulls", "passed  gpu GpuA", "passed  gpu GpuLarge", "passed  python",
            "passed  memcheck GpuB/0", "passed  racecheck GpuB/0",
        )  # fmt: skip
        self.assertEqual(summary.count("passed  gpu GpuB/0"), 1)
        self.assertEqual(summary.count("check Gpu"), 2)
        self.assertIn("all passed", self.said.read_text())
        status, summary = self.run_it("--call", "2")
        self.assertEqual(status, 0, self.said.read_text())
        self.assert_lines(
            summary, "passed  bench", '{"part":"last of gpu_bench"}', "passed  scaling",
            '{"part":"last of scaling_bench"}', "passed  cpu twin_tests", "passed  recipes",
            "passed before  memcheck GpuB/0", "passed  memcheck GpuA",
        )  # fmt: skip

    @unittest.skipIf(shutil.which("ncu"), "this machine has one")
    def test_no_profiler_is_no_failure(self) -> None:
        (self.folder / "path/ncu").unlink()
        status, summary = self.run_it("--only", "ncu")
        self.assertEqual(status, 0, self.said.read_text())
        self.assert_lines(summary, "no ncu here")

    def test_each_failure_is_its_own(self) -> None:
        status, summary = self.run_it(
            "--only",
            "passes,bench,scaling,tests,python,cpu",
            gpu_passes="hang",
            gpu_bench="crash",
            GpuA="skip",
            GpuB="deaf",
            twin_tests="crash",
        )
        self.assertEqual(status, 1)
        self.assert_lines(
            summary, "FAILED: not done within 4 s  passes", '{"part":"first of gpu_passes"}',
            "passed  gpu GpuA", "FAILED: skipped  gpu GpuA",
            "FAILED: not done within 4 s  gpu GpuB/0", "passed  gpu GpuLarge", "passed  python",
            "FAILED with status 139  bench", '{"part":"first of gpu_bench"}', "passed  scaling",
            "FAILED with status 139  cpu twin_tests", "passed  cpu hull",
        )  # fmt: skip
        self.assertNotIn("all passed", self.said.read_text())

    def test_the_question_for_a_device_hangs(self) -> None:
        # The other programs ask for the device themselves.
        text = script.read_text().replace("limited 60 ", "limited 2 ")
        program(self.bundle / "gpu-check.sh", text)
        status, summary = self.run_it("--only", "passes", device="hang")
        self.assertEqual(status, 1)
        self.assert_lines(summary, "FAILED  cullhull does not say", "passed  passes")

    def test_left_out_python_is_a_failure(self) -> None:
        shutil.rmtree(self.bundle / "python")
        status, summary = self.run_it("--only", "python,hulls,recipes")
        self.assertEqual(status, 1)
        for name in ("python", "hulls", "recipes"):
            self.assert_lines(summary, f"LEFT OUT: the bundle was made without it  {name}")

    def test_skipped_python_is_a_failure(self) -> None:
        for name in ("python", "recipes"):
            status, summary = self.run_it("--only", name, python="skip")
            self.assertEqual(status, 1)
            self.assert_lines(summary, f"passed  {name}", "SKIPPED [1]", f"FAILED: skipped  {name}")

    def test_no_device_leaves_the_figures_of_the_processor(self) -> None:
        status, summary = self.run_it("--call", "2", no_device="1")
        self.assertEqual(status, 5)
        self.assert_lines(
            summary, "no device: no driver was found", "LEFT OUT: no device  bench",
            "passed  scaling", '{"part":"last of scaling_bench"}', "passed  cpu twin_tests",
        )  # fmt: skip

    def wait_for(self, text: str, run: subprocess.Popen) -> None:
        for _ in range(300):
            if text in self.summary():
                return
            self.assertIsNone(run.poll(), self.said.read_text())
            time.sleep(0.1)
        self.fail(f"no {text!r} in\n{self.summary()}")

    def test_cut_off(self) -> None:
        for number in (signal.SIGTERM, signal.SIGKILL):
            with self.subTest(number.name):
                shutil.rmtree(self.results, ignore_errors=True)
                run = self.start("--only", "passes,bench,scaling", scaling_bench="hang")
                self.wait_for("passed  bench", run)
                for _ in range(100):
                    if self.figures("cpu-scaling"):
                        break
                    time.sleep(0.1)
                began = time.monotonic()
                run.send_signal(number)
                run.wait(timeout=60)
                self.assertLess(time.monotonic() - began, 2)
                self.assertEqual(self.figures("gpu-passes").count("\n"), 2)
                self.assertEqual(self.figures("gpu-bench").count("\n"), 2)
                self.assertEqual(self.figures("cpu-scaling"), '{"part":"first of scaling_bench"}\n')
                self.assert_lines(self.summary(), "passed  passes", "{", "passed  bench")
                if number == signal.SIGTERM:
                    self.assertIn("during scaling", self.summary())

    def test_the_end_of_the_time(self) -> None:
        status, summary = self.run_it("--only", "passes,tests", "--seconds", "3", gpu_passes="hang")
        self.assertEqual(status, 1)
        self.assert_lines(
            summary, "FAILED: not done within", '{"part":"first', "LEFT OUT: no time left  gpu GpuA"
        )

    def test_tools_and_suites_can_be_chosen(self) -> None:
        status, summary = self.run_it("--tool", "memcheck", "--suite", "GpuA")
        self.assertEqual(status, 0, self.said.read_text())
        self.assert_lines(summary, "passed  memcheck GpuA")
        self.assertEqual(self.calls.read_text().split(), ["memcheck", "GpuA"])
        status, summary = self.run_it("--only", "tests", "--suite", "GpuA,GpuC")
        self.assertEqual(status, 1)
        self.assert_lines(summary, "passed  memcheck GpuA", "FAILED  there is no suite GpuC")
        for wrong in (
            ["--tool", "lint"],
            ["--only", "all"],
            ["--call", "3"],
            ["--tool"],
            ["--seconds", "x"],
        ):
            self.assertEqual(self.run_it(*wrong)[0], 2, wrong)

    def test_the_sanitizer_goes_on_where_it_was(self) -> None:
        everything = ["memcheck GpuA", "memcheck GpuB/0", "racecheck GpuA", "racecheck GpuB/0"]
        status, _ = self.run_it("--tool", "memcheck,racecheck", "--seconds", "4", GpuB="hang")
        self.assertEqual(status, 1)
        done = self.results / "gpu-check-done.txt"
        lines = done.read_text().splitlines()[1:]
        self.assertEqual(lines[:2], ["passed memcheck GpuA", "late memcheck GpuB/0"])
        self.assertLess(len(lines), 4)
        # On another machine, with that file: what ended is not run again, what was late comes last.
        kept = self.folder / "done-before.txt"
        shutil.move(done, kept)
        shutil.rmtree(self.results)
        self.calls.unlink()
        status, summary = self.run_it("--tool", "memcheck,racecheck", "--done", str(kept))
        self.assertEqual(status, 0, self.said.read_text())
        self.assert_lines(
            summary,
            "passed before  memcheck GpuA",
            "passed  racecheck GpuB/0",
            "passed  memcheck GpuB/0",
        )
        self.assertNotIn("memcheck GpuA", " ".join(self.calls.read_text().split()))
        passed = {line for line in done.read_text().splitlines() if line.startswith("passed")}
        self.assertEqual(sorted(line.split(" ", 1)[1] for line in passed), everything)
        # A late one that was done since is not late; of another bundle nothing is known.
        self.calls.unlink()
        self.assertEqual(self.run_it("--tool", "memcheck,racecheck")[0], 0)
        self.assertFalse(self.calls.exists())
        (self.bundle / "about.txt").write_text("commit 2\n")
        self.assertEqual(self.run_it("--tool", "memcheck,racecheck")[0], 0)
        self.assertEqual(len(self.calls.read_text().splitlines()), 8)

    def test_an_earlier_failure_is_still_one(self) -> None:
        self.assertEqual(self.run_it("--tool", "synccheck", GpuA="crash")[0], 1)
        shutil.rmtree(self.folder / "calls", ignore_errors=True)
        status, summary = self.run_it("--tool", "synccheck")
        self.assertEqual(status, 1)
        self.assertIn("FAILED before  synccheck GpuA", summary)


class Stage(Case):
    """Which Python the package is built with. `cmake` stands where the build would begin."""

    def setUp(self) -> None:
        super().setUp()
        self.tree = self.folder / "tree"
        program(self.tree / "scripts/gpu-check.sh", script.read_text())
        # A PATH without the machine's own Pythons.
        self.path = self.folder / "path"
        self.path.mkdir()
        for name in (
            "bash",
            "env",
            "timeout",
            "dirname",
            "cat",
            "rm",
            "mkdir",
            "nproc",
            "realpath",
            "ln",
        ):
            (self.path / name).symlink_to(shutil.which(name))
        program(
            self.path / "cmake",
            f'#!/usr/bin/env bash\nprintf "%s\\n" "$@" >"{self.folder}/cmake"\nexit 7\n',
        )
        self.home = self.folder / "home"
        self.home.mkdir()
        self.python = self.home / ".pyenv/versions/3.12.1/bin/python3.12"

    def stage(self, **more: str) -> subprocess.CompletedProcess:
        environment = {"PATH": str(self.path), "HOME": str(self.home), **more}
        return subprocess.run([str(self.tree / "scripts/gpu-check.sh"), "stage"], env=environment,
                              capture_output=True, text=True, timeout=60)  # fmt: skip

    def good_python(self, path: Path, pip: str = "exit 0") -> None:
        program(
            path,
            f"""#!/usr/bin/env bash
case "$1" in
  -c) exit 0 ;;
  -m) mkdir -p "$3/bin"; ln -s "{path}" "$3/bin/python"
      printf '#!/usr/bin/env bash\\n{pip}\\n' >"$3/bin/pip"; /bin/chmod +x "$3/bin/pip" ;;
esac
""",
        )

    def refused(self, said: subprocess.CompletedProcess, what: str) -> None:
        self.assertEqual(said.returncode, 1, said.stderr)
        self.assertEqual(said.stderr.count("\n"), 1, said.stderr)
        self.assertIn(what, said.stderr)
        self.assertFalse((self.folder / "cmake").exists(), "the build has begun")

    def test_a_shim_that_does_not_start(self) -> None:
        for name in ("python3.12", "python3"):
            program(self.path / name, "#!/usr/bin/env bash\nexit 127\n")
        self.refused(self.stage(), "no Python 3.12 starts here")

    def test_the_next_one_that_starts(self) -> None:
        program(self.path / "python3.12", "#!/usr/bin/env bash\nexit 127\n")
        self.good_python(self.python)
        said = self.stage()
        self.assertEqual(said.returncode, 7, said.stderr)
        words = (self.folder / "cmake").read_text().splitlines()
        self.assertIn(f"-DPython_EXECUTABLE={self.tree}/build/gpu-stage-python/bin/python", words)
        self.assertIn("-DCULLHULL_BUILD_PYTHON=ON", words)
        made_with = self.tree / "build/gpu-stage-python/made-with"
        self.assertEqual(made_with.read_text().strip(), str(self.python))

    def test_the_one_asked_for(self) -> None:
        self.good_python(self.python)
        program(self.folder / "broken", "#!/usr/bin/env bash\nexit 1\n")
        self.refused(
            self.stage(GPU_CHECK_PYTHON=str(self.folder / "broken")), "broken does not start"
        )
        self.refused(self.stage(GPU_CHECK_PYTHON="absent"), "absent does not start")

    def test_pip_fails(self) -> None:
        self.good_python(self.python, pip="exit 1")
        self.refused(self.stage(), "pip cannot install nanobind")


if __name__ == "__main__":
    unittest.main()
