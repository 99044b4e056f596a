#!/usr/bin/env bash
# Everything that needs a GPU, in one go, on a machine that has one but none of our libraries:
#
#   scripts/gpu-check.sh stage [BUNDLE.tar.gz]
#       here: builds GPU tests, their host twins, cullhull, gpu_passes and gpu_bench, and packs them
#       with the shared libraries they use, the C library and its loader among them: where the
#       machine's own is older, the programs are started by that. Default: build/gpu-check.tar.gz.
#       The Python package is in it if there is the Python that the other machine has:
#       GPU_CHECK_PYTHON, python3.12 if not set.
#   scripts/gpu-check.sh run [--call 1|2] [--only PART,...] [--seconds T] [--results FOLDER]
#                            [BUNDLE.tar.gz]
#       there: unpacks and runs, within T seconds (460), the parts cpu (host twins and a hull, no
#       device needed), tests, python (arrays of CuPy and PyTorch), passes (every kind of points, kernels by events), bench (beside
#       Qhull), sanitizer (compute-sanitizer's four tools on small sizes). Call 1 is all but the
#       last, call 2 the last. Writes gpu-check-DATE.txt (device, driver, command, what passed),
#       gpu-check-DATE.log (all output), gpu-passes-DATE.jsonl and gpu-bench-DATE.json to FOLDER,
#       default bench/results, each line as soon as it is known.
#
# Exit status of run: 0 all passed; 1 something failed; 2 bad usage; 5 no device that can be used.
set -euo pipefail

me="gpu-check"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
sanitizer_seconds=${GPU_CHECK_SANITIZER_SECONDS:-100} # for each tool and program

fail() { # STATUS MESSAGE
  echo "$me: $2" >&2
  exit "$1"
}

# ---- stage ------------------------------------------------------------------------------------

# Prints a virtual environment's Python that the package can be built with; nothing if there is none.
stage_python() {
  local python venv=build/gpu-stage-python
  python=$(command -v "${GPU_CHECK_PYTHON:-python3.12}") || return 0
  [[ -x $venv/bin/pip ]] || "$python" -m venv "$venv" >&2
  "$venv/bin/pip" install --quiet --disable-pip-version-check nanobind numpy >&2
  realpath -s "$venv/bin/python"
}

stage() {
  local bundle=${1:-build/gpu-check.tar.gz} python module=()
  cd "$here/.."
  python=$(stage_python)
  if [[ -z $python ]]; then
    echo "$me: no ${GPU_CHECK_PYTHON:-python3.12}: the bundle is without the Python package" >&2
  else
    module=(cullhull_python)
  fi
  local build=build/gpu-stage folder=build/gpu-stage/bundle
  # RPATH, not RUNPATH: the libraries' own dependencies must be found in the bundle, too.
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCULLHULL_WITH_CUDA=ON \
    -DCULLHULL_CUDA_ARCHITECTURES="${GPU_CHECK_ARCHITECTURES:-75-virtual;90-real}" \
    -DCULLHULL_BUILD_TESTS=ON -DCULLHULL_BUILD_BENCH=ON -DCULLHULL_BUILD_EXAMPLES=OFF \
    -DCULLHULL_WITH_HDF5=OFF -DCULLHULL_WITH_MPI=OFF \
    -DCMAKE_BUILD_RPATH='$ORIGIN/../lib' \
    -DCMAKE_{EXE,MODULE}_LINKER_FLAGS="-Wl,--disable-new-dtags -static-libstdc++ -static-libgcc" \
    -U 'Python_*' -U '_Python_*' ${python:+-DPython_EXECUTABLE="$python"} \
    -DCULLHULL_BUILD_PYTHON=$([[ -n $python ]] && echo ON || echo OFF)
  local twins=(primitives_test pseudo_hull_test pseudo_hull_device_test)
  cmake --build "$build" -j "${JOBS:-$(nproc)}" --target cullhull_app cullhull_bench_app gpu_bench gpu_passes gpu_tests \
    "${twins[@]}" "${module[@]}"

  rm -rf "$folder"
  mkdir -p "$folder/bin/cpu" "$folder/lib" "$folder/system"
  cp "$build"/bin/{cullhull,cullhull-bench,gpu_bench,gpu_passes,gpu_tests} "$folder/bin/"
  (cd "$build/bin" && cp "${twins[@]}" "../bundle/bin/cpu/")
  # From bin/cpu the libraries are one folder farther up.
  ln -s ../lib "$folder/bin/lib"
  # The C library is the machine's own where that is not older: then ours stays in its folder.
  local library
  ldd "$folder"/bin/{cullhull,cullhull-bench,gpu_*} "$folder"/bin/cpu/*_test | awk '$2 == "=>" && $3 ~ /^\// {print $3}' |
    sort -u | while read -r library; do
    case "${library##*/}" in
      libc.so.* | libm.so.* | libdl.so.* | librt.so.* | libpthread.so.*)
        cp -L "$library" "$folder/system/"
        ;;
      *) cp -L "$library" "$folder/lib/" ;;
    esac
  done
  if [[ -n $python ]]; then
    mkdir -p "$folder/python/tests"
    cp -r bindings/python/cullhull "$folder/python/"
    cp "$build"/bindings/python/_core.*.so "$folder/python/cullhull/"
    cp bindings/python/tests/test_arrays.py "$folder/python/tests/"
    mkdir "$folder/python/lib"
    # The C++ library is what PyTorch and CuPy run with, which may need a newer one than ours.
    for library in "$folder"/lib/*; do
      [[ $library == *libstdc++* || $library == *libgcc_s* ]] ||
        ln -s "../../lib/${library##*/}" "$folder/python/lib/"
    done
    rm -rf "$folder/python/cullhull/__pycache__"
    strip "$folder"/python/cullhull/_core.*.so
  fi
  local system
  system=$(dirname "$(ldd "$folder/bin/cullhull" | awk '$1 ~ /^libc\.so/ {print $3}')")
  for library in libdl.so.2 librt.so.1 libpthread.so.0; do # the driver's, which may name them
    cp -L "$system/$library" "$folder/system/"
  done
  cp -L "$(ldd "$folder/bin/cullhull" | awk '$1 ~ /ld-linux/ {print $1}')" "$folder/system/loader"
  cp scripts/gpu-check.sh "$folder/"
  strip "$folder"/bin/{cullhull,cullhull-bench,gpu_*} "$folder"/bin/cpu/*_test
  {
    echo "commit $(git rev-parse HEAD 2>/dev/null || echo unknown)$(git diff --quiet HEAD 2>/dev/null || echo ', changed')"
    echo "built $(date -u +%Y-%m-%dT%H:%M:%SZ) with $(nvcc --version 2>/dev/null | tail -1 || echo nvcc)"
  } >"$folder/about.txt"
  # Started by its own loader a program must open nothing of the machine's: then it runs whatever
  # that has (glibc 2.28 and older), and the driver's libraries, which ask for less, beside it.
  local program strange own
  own=$(realpath "$folder")
  for program in "$own"/bin/{cullhull,cullhull-bench,gpu_*} "$own"/bin/cpu/*_test; do
    strange=$("$own/system/loader" --library-path "$own/lib:$own/system" --list "$program" |
      awk -v own="$own/" '/=>/ && index($3, own) != 1 {print $1}')
    [[ -z $strange ]] || fail 1 "$program would take from the machine: $strange"
  done
  mkdir -p "$(dirname "$bundle")"
  tar -C "$folder" -czf "$bundle" .
  local bytes
  bytes=$(stat -c %s "$bundle")
  ((bytes < 40 << 20)) || fail 1 "$bundle has $bytes bytes, more than 40 MiB"
  echo "$me: $bundle, $bytes bytes; carry it to a machine with a GPU, unpack it, ./gpu-check.sh run"
}

# ---- run --------------------------------------------------------------------------------------

failures=0
launcher=() # how a program of the bundle is started; nothing where it starts by itself

find_launcher() {
  if "$root/bin/cullhull" --version >>"$log" 2>&1; then
    echo "C library: this machine's" >>"$summary"
    return
  fi
  # The driver's libraries lie where this machine's own loader knows, or where containers have them.
  local folders="$root/lib:$root/system" driver
  for driver in /usr/lib/x86_64-linux-gnu /lib/x86_64-linux-gnu /usr/lib64 /usr/local/nvidia/lib64; do
    [[ -e $driver/libcuda.so.1 ]] && folders+=:$driver
  done
  launcher=("$root/system/loader" --library-path "$folders")
  "${launcher[@]}" "$root/bin/cullhull" --version >>"$log" 2>&1 ||
    fail 1 "the bundle's programs do not start here; see $log"
  echo "C library: the bundle's" >>"$summary"
}

left() { echo $((deadline - SECONDS)); }

# NAME COMMAND...: its output goes to the log as it comes, its outcome to the summary. No step goes
# on beyond the end of the whole.
step() {
  local name=$1 status=0 start=$SECONDS
  shift
  if (($(left) < 2)); then
    echo "LEFT OUT: no time left  $name" | tee -a "$summary"
    failures=$((failures + 1))
    return
  fi
  echo "== $name: $*" >>"$log"
  timeout "$(left)" "$@" >>"$log" 2>&1 || status=$?
  local line="passed"
  ((status == 0)) || line="FAILED with status $status"
  ((status == 124)) && line="FAILED: not done in time"
  ((status == 0)) || failures=$((failures + 1))
  echo "$line  $name  ($((SECONDS - start)) s)" | tee -a "$summary"
}

# A test that skips has not passed here.
step_of_all() { # NAME COMMAND...
  local before=$failures from
  from=$(wc -l <"$log")
  step "$@"
  if ((failures == before)) && tail -n "+$((from + 1))" "$log" | grep -q '\[  SKIPPED \]'; then
    echo "FAILED: skipped  $1" | tee -a "$summary"
    failures=$((failures + 1))
  fi
}

run_cpu() {
  local test
  for test in "$root"/bin/cpu/*_test; do
    step "cpu ${test##*/}" "${launcher[@]}" "$test" --gtest_brief=1
  done
  step "cpu generate" "${launcher[@]}" "$root/bin/cullhull" generate ball -n 100000 -d 3 --type f32 -o "$scratch/p.npy"
  step "cpu hull" "${launcher[@]}" "$root/bin/cullhull" hull "$scratch/p.npy" --backend cpu --certify
}

need_device() {
  local report reason
  if [[ -r /proc/driver/nvidia/version ]]; then
    sed -n 's/^NVRM version: /driver /p' /proc/driver/nvidia/version >>"$summary"
  fi
  report=$("${launcher[@]}" "$root/bin/cullhull-bench" machine --bytes 1MiB --passes 1 --json) ||
    fail 1 "cullhull-bench machine does not run here"
  reason=$(sed -n 's/^ *"no_device": "\(.*\)",\{0,1\}$/\1/p' <<<"$report")
  if [[ -n $reason ]]; then
    echo "no device: $reason" >>"$summary"
    fail 5 "no CUDA device that can be used: $reason"
  fi
  sed -n 's/^ *"name": "\(.*\)",$/device \1/p' <<<"$report" >>"$summary"
}

# Sets `suites`, the names of the suites of gpu_tests.
list_suites() {
  suites=$("${launcher[@]}" "$root/bin/gpu_tests" --gtest_list_tests | sed -n 's/^\([A-Za-z]*\)\.$/\1/p')
  [[ -n $suites ]] || fail 1 "gpu_tests does not name its tests here"
}

run_tests() {
  local suites suite
  list_suites
  for suite in $suites; do
    step_of_all "gpu $suite" "${launcher[@]}" "$root/bin/gpu_tests" --gtest_filter="$suite.*" --gtest_brief=0
  done
  step "gpu hull" "${launcher[@]}" "$root/bin/cullhull" hull "$scratch/p.npy" --backend cuda --certify
}

# By the machine's own Python, and so its C library. A test that skips has not passed.
run_python() {
  local before=$failures tests=$root/python/tests/test_arrays.py from
  if [[ ! -d $root/python ]]; then
    echo "LEFT OUT: the bundle was made without it  python" | tee -a "$summary"
    return
  fi
  from=$(wc -l <"$log")
  step "python" env PYTHONPATH="$root/python" PYTHONDONTWRITEBYTECODE=1 python3 -m pytest -q -rs -p no:cacheprovider \
    "$tests"::test_{batches_and_questions_on_a_device,device_arrays_of_side_streams,device_arrays}
  if ((failures == before)) && tail -n "+$((from + 1))" "$log" | grep '^SKIPPED' >>"$summary"; then
    echo "FAILED: skipped  python" | tee -a "$summary"
    failures=$((failures + 1))
  fi
}

run_sanitizer() {
  local sanitizer tool suites suite
  sanitizer=$(command -v compute-sanitizer || ls /usr/local/cuda*/bin/compute-sanitizer 2>/dev/null | tail -1) || true
  if [[ -z $sanitizer ]]; then
    echo "FAILED  compute-sanitizer is not here" | tee -a "$summary"
    failures=$((failures + 1))
    return
  fi
  list_suites
  for tool in memcheck racecheck initcheck synccheck; do
    for suite in $suites; do
      [[ $suite != *Large ]] || continue
      step "$tool $suite" env CULLHULL_GPU_TESTS=short timeout "$sanitizer_seconds" "$sanitizer" --tool "$tool" \
        --error-exitcode 9 "${launcher[@]}" "$root/bin/gpu_tests" --gtest_filter="$suite.*" --gtest_brief=1
    done
  done
}

run_passes() {
  # What is left is for gpu_bench, which has the rivals.
  step "passes" "${launcher[@]}" "$root/bin/gpu_passes" --out "$results/gpu-passes-$date.jsonl" \
    --seconds $(($(left) / 2))
  if [[ -f $results/gpu-passes-$date.jsonl ]]; then
    cat "$results/gpu-passes-$date.jsonl" >>"$summary"
  fi
}

run_bench() {
  step "bench" "${launcher[@]}" "$root/bin/gpu_bench" --json "$results/gpu-bench-$date.json"
  sed -n '/^== bench: /,$p' "$log" | tail -n +2 >>"$summary"
}

wants() { [[ ,$only, == *",$1,"* ]]; }

run() {
  local only=cpu,tests,python,passes,bench,sanitizer bundle="" words="$0 run $*" seconds=460
  results=""
  while (($#)); do
    case "$1" in
      --only) only=${2:?} && shift ;;
      --call)
        case "${2:?}" in
          1) only=cpu,tests,python,passes,bench ;;
          2) only=sanitizer ;;
          *) fail 2 "there are calls 1 and 2" ;;
        esac
        shift
        ;;
      --seconds) seconds=${2:?} && shift ;;
      --results) results=${2:?} && shift ;;
      -*) fail 2 "unknown option $1" ;;
      *) bundle=$1 ;;
    esac
    shift
  done
  local part
  for part in ${only//,/ }; do
    [[ " cpu tests python passes bench sanitizer " == *" $part "* ]] || fail 2 "unknown part $part"
  done
  deadline=$((SECONDS + seconds))
  scratch=$(mktemp -d)
  trap 'rm -rf "$scratch"' EXIT
  if [[ -z $bundle && -d $here/bin/cpu ]]; then # unpacked already
    root=$here
    : "${results:=$here/results}"
  else
    : "${bundle:=$here/../build/gpu-check.tar.gz}" "${results:=$here/../bench/results}"
    [[ -f $bundle ]] || fail 2 "no bundle $bundle: make one with '$me.sh stage'"
    root=$scratch/bundle
    mkdir "$root"
    tar -C "$root" -xzf "$bundle"
  fi
  mkdir -p "$results"
  date=$(date -u +%Y%m%d-%H%M%S)
  log=$results/gpu-check-$date.log summary=$results/gpu-check-$date.txt
  {
    echo "date $(date -u +%Y-%m-%dT%H:%M:%SZ)"
    echo "command $words"
    cat "$root/about.txt"
  } | tee "$summary"
  find_launcher
  if wants cpu; then run_cpu; fi
  if wants tests || wants python || wants passes || wants bench || wants sanitizer; then
    need_device
    [[ -f $scratch/p.npy ]] ||
      "${launcher[@]}" "$root/bin/cullhull" generate ball -n 100000 -d 3 --type f32 -o "$scratch/p.npy"
    if wants tests; then run_tests; fi
    if wants python; then run_python; fi
    if wants passes; then run_passes; fi
    if wants bench; then run_bench; fi
    if wants sanitizer; then run_sanitizer; fi
  fi
  ((failures == 0)) || fail 1 "$failures steps failed; see $log"
  echo "$me: all passed; results in $results"
}

case "${1:-}" in
  stage | run)
    "$@"
    ;;
  *) fail 2 "usage: $0 stage [BUNDLE.tar.gz] | run [--call 1|2] [--only PART,...] [--seconds T] [--results FOLDER] [BUNDLE.tar.gz]" ;;
esac
