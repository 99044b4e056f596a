#!/usr/bin/env bash
# What `make test` and `make test-all` do: scripts/run-tests.sh short|all
#   short  builds and runs the tests of library, program, Python package and the samples of the pages.
#          Random tests that take long (tests/sampled.txt) run a tenth of their sets.
#   all    builds and runs every test. What `short` has run in this build folder, with the sources
#          unchanged since, is not run again, except for those random tests, now with all their sets.
# JOBS: how many sources are compiled at once (default: the processors).
set -euo pipefail
cd "$(dirname "$0")/.."
build=build/release
passed=$build/short-tests-passed
which=${1-}

# What `short` runs of the package's tests.
mapfile -t short_python < <(bindings/python/tests/run.sh --short-files)

settings=(-DCULLHULL_FAST_BUILD=ON -DCULLHULL_BUILD_TESTS=ON -DCULLHULL_BUILD_BENCH=OFF)
case $which in
  short)
    parts=(build test python)
    # Neither CUDA nor MPI nor the benchmarks are compiled for these, whatever this machine has.
    settings+=(-DCULLHULL_TESTS=short -DCULLHULL_WITH_CUDA=OFF -DCULLHULL_WITH_MPI=OFF) ;;
  all)
    parts=(build test-all python docs)
    # Where packages can be installed, no test is left out for want of one.
    tests=found
    if command -v apt-get >/dev/null; then tests=all; fi
    settings+=("-DCULLHULL_TESTS=$tests" -DCULLHULL_WITH_CUDA=AUTO -DCULLHULL_WITH_MPI=AUTO)
    # Kernels that no device runs here are compiled for one kind of device.
    if ! nvidia-smi -L >/dev/null 2>&1; then settings+=(-DCULLHULL_CUDA_ARCHITECTURES=90-real); fi ;;
  *)
    sed -n '2,7s/^# \{0,1\}//p' "$0" >&2
    exit 2 ;;
esac

# The tree's files that are there; none where this is no clone.
files() {
  { git ls-files -co --exclude-standard -z | xargs -0r ls -d | sort; } 2>/dev/null || true
}

# Whether `short` has passed here with the same files, of which none is newer.
unchanged_since() {
  [[ -s $passed ]] && files | cmp -s - "$passed" || return 1
  [[ -z $(files | tr '\n' '\0' | xargs -0 sh -c 'find "$@" -maxdepth 0 -newer "$0"' "$passed") ]]
}

run() { ctest --test-dir "$build" -j 2 --output-on-failure "$@"; }

# What is about to happen, before anything does. A test of C++ may be many by its parameters.
cpp=$(grep -rhE '^TEST' tests --include='*_test.c*' | wc -l)
python=$(grep -hE '^def test_' bindings/python/tests/test_*.py | wc -l)
if [[ $which == short ]]; then
  cpp=$(grep -hE '^TEST' tests/{reference,exactness,agreement,delaunay,diagrams,viewer}/*_test.cpp | wc -l)
  python=$(grep -hE '^def test_' "${short_python[@]/#/bindings/python/tests/}" | wc -l)
  cat <<END
make test: library, program, Python package, samples of the pages
  tests     about $cpp of C++, $python of Python
  installs  GoogleTest, Qhull, lrs and Python by apt; NumPy, SciPy and what their tests need from PyPI,
            into $build/python: 250 MB to fetch and 2 GB on disk at most, with the build
  takes     about twice as long as make demo
END
else
  cat <<END
make test-all: every test
  tests     about $cpp of C++, $python of Python, the matrix of commands
            and functions, other projects' own tests, a browser, an emulated device, packages
  installs  besides what make test does: CGAL, Boost, TBB, OpenMPI, HDF5, Doxygen, a browser by apt;
            some 70 packages from PyPI, into $build/python: 1.2 GB to fetch and 7.5 GB on disk, with the build
  takes     about four times as long as make demo
END
fi
scripts/install-deps.sh "${parts[@]}"

if [[ $which == short ]]; then mkdir -p "$build" && files >"$passed.begun"; fi
cmake --preset release "${settings[@]}"
cmake --build "$build" -j "${JOBS:-$(nproc)}"
if [[ $which == short ]]; then
  rm -f "$passed"
  CULLHULL_TEST_SHARE=0.1 run -L '^(test|sampled)$'
  mv "$passed.begun" "$passed" # as old as the start: what has changed since then is newer
elif unchanged_since; then
  echo "run-tests: $(ctest --test-dir "$build" -N -L '^test$' | sed -n 's/^Total Tests: //p') tests" \
    "passed in make test and are not run again"
  # Their environment is there, too; what is installed now has MPI and CUDA.
  run -LE '^test$' -FS '^python$'
else
  run
fi
