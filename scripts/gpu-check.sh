#!/usr/bin/env bash
# Everything that needs a GPU, in one go, on a machine that has one but none of our libraries:
#
#   scripts/gpu-check.sh stage [BUNDLE.tar.gz]
#       here: builds GPU tests, their host twins, cullhull and the programs that measure, and packs
#       them with the shared libraries they use, the C library and its loader among them: where the
#       machine's own is older, the programs are started by that. Default: build/gpu-check.tar.gz.
#       The Python package is built for the Python of the other machine: GPU_CHECK_PYTHON, else the
#       first Python 3.12 that starts. Without one the bundle is not made.
#   scripts/gpu-check.sh run [--call 1|2] [--only PART,...] [--tool TOOL,...] [--suite SUITE,...]
#                            [--done FILE] [--seconds T] [--results FOLDER] [BUNDLE.tar.gz]
#       there: unpacks and runs, within T seconds (360), these parts in this order:
#         changed    the tests of what changed since a device last ran them
#         passes     whole calls of many kinds of points and their steps, beside predictions
#         ncu        Nsight Compute on the heaviest kernels, where it is installed
#         hulls      hulls from Python, of many kinds and sizes, beside the CPU's: the same bits
#         tests      every suite of the tests of a device, but those that `changed` ran
#         python     arrays of CuPy and PyTorch
#         bench      whole hulls beside our CPU and Qhull on the same points
#         scaling    1, 2, 4, 8 and 16 threads of the CPU (needs no device)
#         cpu        the tests' host twins and a hull (needs no device)
#         recipes    those of docs/how-to/frameworks.md for PyTorch and CuPy
#         sanitizer  compute-sanitizer's tools (--tool: memcheck, racecheck, initcheck, synccheck)
#                    over the suites with short sets, an hour in all
#       Call 1 is the parts up to python, then memcheck and racecheck over what changed; call 2 is
#       the others. --suite limits tests and sanitizer.
#       Writes to FOLDER, default bench/results, each line as soon as it is known:
#       gpu-check-DATE.txt (device, CPU, clocks, what passed), gpu-check-DATE.log (all output),
#       gpu-passes-, gpu-bench- and cpu-scaling-DATE.jsonl, and gpu-check-done.txt: the runs of
#       compute-sanitizer that ended, which the next call with the same bundle skips. --done names
#       that file where it lies elsewhere.
#
# A run that was cut off has written all that it knew. Every step has a limit of its own, so that a
# program that hangs does not take the others with it; a step left out is a failure.
#
# Exit status of run: 0 all passed; 1 something failed; 2 bad usage; 5 no device that can be used.
set -euo pipefail
shopt -s inherit_errexit # a command that fails within $( ) ends it

me="gpu-check"
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
# Limits in seconds: of a suite, of a suite under compute-sanitizer, and of the parts that measure.
suite_seconds=${GPU_CHECK_SUITE_SECONDS:-90}
sanitizer_seconds=${GPU_CHECK_SANITIZER_SECONDS:-60}
passes_seconds=${GPU_CHECK_PASSES_SECONDS:-100}
ncu_seconds=${GPU_CHECK_NCU_SECONDS:-45}
bench_seconds=${GPU_CHECK_BENCH_SECONDS:-110}
scaling_seconds=${GPU_CHECK_SCALING_SECONDS:-80}

# Suites of what changed since a device last ran them.
changed_suites=${GPU_CHECK_CHANGED_SUITES:-StarHullGpu GpuTracker GpuSets CudaGauge GpuQuestions}

fail() { # STATUS MESSAGE
  echo "$me: $2" >&2
  exit "$1"
}

# ---- stage ------------------------------------------------------------------------------------

# Whether this is a Python that starts, of that version (any, where none is given), and can make a
# virtual environment. What a version manager puts on PATH may be no more than a name.
starts() { # PYTHON [VERSION]
  timeout -k 5 30 "$1" -c 'import ensurepip, sys, venv
sys.exit(sys.argv[1] not in ("", "%d.%d" % sys.version_info[:2]))' "${2:-}" >/dev/null 2>&1 </dev/null
}

# Prints the first Python that starts among the one asked for, or all that may be a Python 3.12.
find_python() {
  local version=3.12 candidate candidates
  if [[ -n ${GPU_CHECK_PYTHON:-} ]]; then
    candidate=$(command -v "$GPU_CHECK_PYTHON") && starts "$candidate" ||
      fail 1 "GPU_CHECK_PYTHON: $GPU_CHECK_PYTHON does not start"
    echo "$candidate"
    return
  fi
  mapfile -t candidates < <(type -ap "python$version" python3 || true)
  candidates+=("${PYENV_ROOT:-$HOME/.pyenv}/versions/$version".*/bin/python"$version")
  for candidate in "${candidates[@]}"; do
    if starts "$candidate" "$version"; then
      echo "$candidate"
      return
    fi
  done
  fail 1 "no Python $version starts here, which the Python package is built for: set GPU_CHECK_PYTHON"
}

# Prints a virtual environment's Python that the package can be built with.
stage_python() {
  local python venv=build/gpu-stage-python
  python=$(find_python)
  if ! starts "$venv/bin/python" || [[ $(cat "$venv/made-with" 2>/dev/null) != "$python" ]]; then
    rm -rf "$venv"
    "$python" -m venv "$venv" >&2 || fail 1 "$python cannot make a virtual environment"
    echo "$python" >"$venv/made-with"
  fi
  "$venv/bin/pip" install --quiet --disable-pip-version-check nanobind numpy >&2 ||
    fail 1 "pip cannot install nanobind and numpy for $python"
  realpath -s "$venv/bin/python"
}

stage() {
  local bundle=${1:-build/gpu-check.tar.gz} python
  cd "$here/.."
  python=$(stage_python)
  local build=build/gpu-stage folder=build/gpu-stage/bundle
  # RPATH, not RUNPATH: the libraries' own dependencies must be found in the bundle, too.
  cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCULLHULL_WITH_CUDA=ON \
    -DCULLHULL_CUDA_ARCHITECTURES="${GPU_CHECK_ARCHITECTURES:-75-virtual;90-real}" \
    -DCULLHULL_BUILD_TESTS=ON -DCULLHULL_BUILD_BENCH=ON -DCULLHULL_BUILD_EXAMPLES=OFF \
    -DCULLHULL_WITH_HDF5=OFF -DCULLHULL_WITH_MPI=OFF \
    -DCMAKE_BUILD_RPATH='$ORIGIN/../lib' \
    -DCMAKE_{EXE,MODULE}_LINKER_FLAGS="-Wl,--disable-new-dtags -static-libstdc++ -static-libgcc" \
    -U 'Python_*' -U '_Python_*' -DPython_EXECUTABLE="$python" -DCULLHULL_BUILD_PYTHON=ON
  local twins=(reference_tests agreement_tests)
  cmake --build "$build" -j "${JOBS:-$(nproc)}" --target cullhull_app cullhull_bench_app gpu_bench gpu_passes gpu_tests \
    scaling_bench cullhull_python "${twins[@]}"

  rm -rf "$folder"
  mkdir -p "$folder/bin/cpu" "$folder/lib" "$folder/system"
  cp "$build"/bin/{cullhull,gpu_bench,gpu_passes,gpu_tests,scaling_bench} "$folder/bin/"
  (cd "$build/bin" && cp "${twins[@]}" "../bundle/bin/cpu/")
  # From bin/cpu the libraries are one folder farther up.
  ln -s ../lib "$folder/bin/lib"
  # The C library is the machine's own where that is not older: then ours stays in its folder.
  local library
  ldd "$folder"/bin/{cullhull,gpu_*,scaling_bench} "$folder"/bin/cpu/*_tests | awk '$2 == "=>" && $3 ~ /^\// {print $3}' |
    sort -u | while read -r library; do
    case "${library##*/}" in
      libc.so.* | libm.so.* | libdl.so.* | librt.so.* | libpthread.so.*)
        cp -L "$library" "$folder/system/"
        ;;
      *) cp -L "$library" "$folder/lib/" ;;
    esac
  done
  mkdir -p "$folder/python/tests"
  cp -r bindings/python/cullhull "$folder/python/"
  cp "$build"/bindings/python/_core.*.so "$folder/python/cullhull/"
  cp bindings/python/tests/{programs,test_arrays,test_recipes}.py docs/how-to/frameworks.md "$folder/python/tests/"
  cp bench/device_hulls.py data/autzen-150k.ply "$folder/python/"
  mkdir "$folder/python/lib"
  # The C++ library is what PyTorch and CuPy run with, which may need a newer one than ours.
  for library in "$folder"/lib/*; do
    [[ $library == *libstdc++* || $library == *libgcc_s* ]] ||
      ln -s "../../lib/${library##*/}" "$folder/python/lib/"
  done
  rm -rf "$folder/python/cullhull/__pycache__"
  strip "$folder"/python/cullhull/_core.*.so
  local system
  system=$(dirname "$(ldd "$folder/bin/cullhull" | awk '$1 ~ /^libc\.so/ {print $3}')")
  for library in libdl.so.2 librt.so.1 libpthread.so.0; do # the driver's, which may name them
    cp -L "$system/$library" "$folder/system/"
  done
  cp -L "$(ldd "$folder/bin/cullhull" | awk '$1 ~ /ld-linux/ {print $1}')" "$folder/system/loader"
  cp scripts/gpu-check.sh "$folder/"
  strip "$folder"/bin/{cullhull,gpu_*,scaling_bench} "$folder"/bin/cpu/*_tests
  {
    echo "commit $(git rev-parse HEAD 2>/dev/null || echo unknown)$(git diff --quiet HEAD 2>/dev/null || echo ', changed')"
    echo "built $(date -u +%Y-%m-%dT%H:%M:%SZ) with $(nvcc --version 2>/dev/null | tail -1 || echo nvcc)"
  } >"$folder/about.txt"
  # Started by its own loader a program must open nothing of the machine's: then it runs whatever
  # that has (glibc 2.28 and older), and the driver's libraries, which ask for less, beside it.
  local program strange own
  own=$(realpath "$folder")
  for program in "$own"/bin/{cullhull,gpu_*,scaling_bench} "$own"/bin/cpu/*_tests; do
    strange=$("$own/system/loader" --library-path "$own/lib:$own/system" --list "$program" |
      awk -v own="$own/" '/=>/ && index($3, own) != 1 {print $1}')
    [[ -z $strange ]] || fail 1 "$program would take from the machine: $strange"
  done
  mkdir -p "$(dirname "$bundle")"
  tar -C "$folder" -czf "$bundle" .
  local bytes
  bytes=$(stat -c %s "$bundle")
  ((bytes < 56 << 20)) || fail 1 "$bundle has $bytes bytes, more than 56 MiB"
  echo "$me: $bundle, $bytes bytes; carry it to a machine with a GPU, unpack it, ./gpu-check.sh run"
}

# ---- run --------------------------------------------------------------------------------------

failures=0
launcher=()  # how a program of the bundle is started; nothing where it starts by itself
child=""     # the process of the step that runs now
running=""   # and its name
outcome=""   # of the last step: passed, failed, late or left-out

note() { echo "$1" | tee -a "$summary"; }

failed() { # LINE
  note "$1"
  failures=$((failures + 1))
}

# Whoever ends this script ends the program it runs; what is known is written already.
cut_off() {
  note "CUT OFF after $SECONDS s${running:+, during $running}"
  [[ -z $child ]] || kill "$child" 2>/dev/null || true
  exit 1
}

left() { echo $((deadline - SECONDS)); }

least() { echo $(($1 < $2 ? $1 : $2)); }

# SECONDS COMMAND...: its exit status; 124 or 137 if it had to be ended.
limited() {
  local status=0
  timeout -k 5 "$@" </dev/null &
  child=$!
  wait "$child" || status=$?
  child=""
  return "$status"
}

find_launcher() {
  if limited 20 "$root/bin/cullhull" --version >>"$log" 2>&1; then
    echo "C library: this machine's" >>"$summary"
    return
  fi
  # The driver's libraries lie where this machine's own loader knows, or where containers have them.
  local folders="$root/lib:$root/system" driver
  for driver in /usr/lib/x86_64-linux-gnu /lib/x86_64-linux-gnu /usr/lib64 /usr/local/nvidia/lib64; do
    [[ -e $driver/libcuda.so.1 ]] && folders+=:$driver
  done
  launcher=("$root/system/loader" --library-path "$folders")
  limited 20 "${launcher[@]}" "$root/bin/cullhull" --version >>"$log" 2>&1 ||
    fail 1 "the bundle's programs do not start here; see $log"
  echo "C library: the bundle's" >>"$summary"
}

# LIMIT NAME COMMAND...: its output goes to the log as it comes, its outcome to the summary. No step
# goes on beyond its limit or the end of the whole.
step() {
  local limit=$1 name=$2 status=0 start=$SECONDS
  shift 2
  limit=$(least "$limit" "$(left)")
  if ((limit < 2)); then
    outcome=left-out
    failed "LEFT OUT: no time left  $name"
    return
  fi
  echo "== $name: $*" >>"$log"
  running=$name
  limited "$limit" "$@" >>"$log" 2>&1 || status=$?
  running=""
  case $status in
    0) outcome=passed ;;
    124 | 137) outcome=late ;;
    *) outcome=failed ;;
  esac
  case $outcome in
    passed) note "passed  $name  ($((SECONDS - start)) s)" ;;
    late) failed "FAILED: not done within $limit s  $name" ;;
    failed) failed "FAILED with status $status  $name  ($((SECONDS - start)) s)" ;;
  esac
}

log_lines() { wc -l <"$log"; }

# FIRST PATTERN: the lines of the log after the FIRST ones that match. The whole log is read: a
# reader that ends early would end its writer, and so the script.
logged() { tail -n "+$(($1 + 1))" "$log" | sed -n "/$2/p"; }

# A test that skips has not passed here.
no_skips() { # FIRST PATTERN NAME
  local skipped
  [[ $outcome == passed ]] || return 0
  skipped=$(logged "$1" "$2")
  [[ -z $skipped ]] || failed "FAILED: skipped  $3"
}

step_of_all() { # LIMIT NAME COMMAND...
  local from
  from=$(log_lines)
  step "$@"
  no_skips "$from" '\[  SKIPPED \]' "$2"
}

# The processor, once, and what the driver says of the device's clocks and memory, at this moment.
record_cpu() {
  local name
  name=$(sed -n '/^model name/{s/^[^:]*: *//p;q}' /proc/cpuinfo)
  note "cpu ${name:-unknown}, $(nproc) cores to be used, $(sed -n 's/^MemTotal: *//p' /proc/meminfo) of memory"
  { lscpu 2>/dev/null || true; } |
    sed -n 's/^ *\(Thread(s) per core\|Core(s) per socket\|Socket(s)\|CPU max MHz\|Hypervisor vendor\): */cpu \1: /p' >>"$summary"
}

record_device() { # WHEN
  local fields=name,driver_version,ecc.mode.current,persistence_mode,power.limit,temperature.gpu
  fields+=,clocks.current.sm,clocks.current.memory,clocks.max.sm,clocks.max.memory
  if ! limited 20 nvidia-smi --query-gpu="$fields" --format=csv >"$scratch/smi.txt" 2>>"$log"; then
    echo "nvidia-smi $1: no answer" >>"$summary"
    return
  fi
  sed "s/^/nvidia-smi $1: /" "$scratch/smi.txt" >>"$summary"
}

run_cpu() {
  local test
  for test in "$root"/bin/cpu/*_tests; do # the host twins of what runs on a device
    step "$suite_seconds" "cpu ${test##*/}" "${launcher[@]}" "$test" --gtest_brief=1 \
      --gtest_filter='Primitives.*:FacetStream.*:PseudoHull*'
  done
  make_points
  step 30 "cpu hull" "${launcher[@]}" "$root/bin/cullhull" hull "$scratch/p.npy" --backend cpu --certify
}

make_points() {
  [[ -f $scratch/p.npy ]] ||
    step 30 "cpu generate" "${launcher[@]}" "$root/bin/cullhull" generate ball -n 100000 -d 3 --type f32 -o "$scratch/p.npy"
}

# Sets `no_device`, the reason why there is none.
find_device() {
  local points=$scratch/four.txt answer=$scratch/device.txt status=0
  no_device=""
  if [[ -r /proc/driver/nvidia/version ]]; then
    sed -n 's/^NVRM version: /driver /p' /proc/driver/nvidia/version >>"$summary"
  fi
  printf '%s\n' '0 0 0' '1 0 0' '0 1 0' '0 0 1' >"$points"
  limited 60 "${launcher[@]}" "$root/bin/cullhull" hull "$points" --backend cuda >"$answer" 2>&1 || status=$?
  cat "$answer" >>"$log"
  if [[ $status -eq 5 ]]; then
    no_device=$(sed 's/^cullhull: //' "$answer")
    note "no device: $no_device"
  elif [[ $status -ne 0 ]]; then
    failed "FAILED  cullhull does not say what device there is" # every program asks for it again
  else
    record_device "at the start"
  fi
}

# Sets `suites`: those of gpu_tests, of KIND (changed, others or all), that --suite leaves.
list_suites() { # KIND
  local names suite
  suites=()
  limited 30 "${launcher[@]}" "$root/bin/gpu_tests" --gtest_list_tests >"$scratch/suites.txt" 2>>"$log" || true
  names=$(sed -n 's/^\([^ ]*\)\.\( .*\)\{0,1\}$/\1/p' "$scratch/suites.txt")
  if [[ -z $names ]]; then
    failed "FAILED  gpu_tests does not name its tests here"
    return
  fi
  for suite in ${only_suites//,/ }; do
    [[ $'\n'$names$'\n' == *$'\n'"$suite"$'\n'* ]] || failed "FAILED  there is no suite $suite"
  done
  for suite in $names; do
    local kind=others
    [[ " $changed_suites " != *" $suite "* ]] || kind=changed
    [[ $1 == all || $1 == "$kind" ]] || continue
    [[ -n $only_suites && ,$only_suites, != *",$suite,"* ]] || suites+=("$suite")
  done
}

run_suites() { # KIND
  local suites suite
  list_suites "$1"
  for suite in "${suites[@]}"; do
    step_of_all "$suite_seconds" "gpu $suite" "${launcher[@]}" "$root/bin/gpu_tests" --gtest_filter="$suite.*" --gtest_brief=0
  done
}

run_changed() {
  make_points
  step 30 "gpu hull" "${launcher[@]}" "$root/bin/cullhull" hull "$scratch/p.npy" --backend cuda --certify
  run_suites changed
}

run_tests() { run_suites "$(wants changed && echo others || echo all)"; }

# The kernels of a ball: leaders, places, growth, both steps of flips, the block that ends them.
run_ncu() {
  local ncu
  if ! ncu=$(command -v ncu); then
    note "no ncu here"
    return
  fi
  step "$ncu_seconds" ncu "$ncu" --set basic --kernel-name-base demangled --launch-count 60 --kernel-name \
    'regex:OfferLeader|AssignToCones|ReassignToCones|SplitStarFacet|FlipStep|rounds_of_block' \
    "${launcher[@]}" "$root/bin/gpu_passes" --part "first call"
}

# By the machine's own Python, and so its C library. A test that skips has not passed.
python_step() { # NAME PYTEST ARGUMENTS...: a test that skips has not passed
  local name=$1 from
  shift
  if [[ ! -d $root/python ]]; then
    failed "LEFT OUT: the bundle was made without it  $name"
    return
  fi
  from=$(log_lines)
  step "$suite_seconds" "$name" env PYTHONPATH="$root/python" PYTHONDONTWRITEBYTECODE=1 python3 -m pytest -q -rs -p no:cacheprovider "$@"
  logged "$from" '^SKIPPED' >>"$summary"
  no_skips "$from" '^SKIPPED' "$name"
}

run_python() {
  python_step python "$root/python/tests/test_arrays.py"::test_{batches_and_questions_on_a_device,device_arrays_of_side_streams,device_arrays}
}

run_hulls() {
  if [[ ! -d $root/python ]]; then
    failed "LEFT OUT: the bundle was made without it  hulls"
    return
  fi
  figures "$suite_seconds" hulls "$results/gpu-hulls-$date.jsonl" env PYTHONPATH="$root/python" \
    PYTHONDONTWRITEBYTECODE=1 python3 "$root/python/device_hulls.py" "$root/python/autzen-150k.ply"
}

run_recipes() {
  python_step recipes "$root/python/tests/test_recipes.py" -k "torch or cupy"
}

# A run of one tool over one suite is a line of `$done_file` once it has ended: a later call goes on
# after it. Those that were not done in time come last.
run_sanitizer() {
  local sanitizer tool suite job jobs=() late=() suites known=""
  sanitizer=$(command -v compute-sanitizer || ls /usr/local/cuda*/bin/compute-sanitizer 2>/dev/null | tail -1) || true
  if [[ -z $sanitizer ]]; then
    failed "FAILED  compute-sanitizer is not here"
    return
  fi
  list_suites "$sanitized"
  local bundle
  bundle="bundle $(cksum <"$root/about.txt")"
  if [[ -f $done_before ]]; then
    if grep -qxF -- "$bundle" "$done_before"; then
      known=$(grep -v '^bundle ' "$done_before" || true)
    else
      note "$done_before is of another bundle: everything is run again"
    fi
  fi
  { echo "$bundle"; [[ -z $known ]] || echo "$known"; } >"$done_file.new"
  mv "$done_file.new" "$done_file"
  for tool in ${tools//,/ }; do
    for suite in "${suites[@]}"; do
      [[ $suite != *Large ]] || continue
      job="$tool $suite"
      case $'\n'$known$'\n' in
        *$'\n'"passed $job"$'\n'*) note "passed before  $job" ;;
        *$'\n'"failed $job"$'\n'*) failed "FAILED before  $job" ;;
        *$'\n'"late $job"$'\n'*) late+=("$job") ;;
        *) jobs+=("$job") ;;
      esac
    done
  done
  for job in "${jobs[@]}" "${late[@]}"; do
    read -r tool suite <<<"$job"
    step "$sanitizer_seconds" "$job" env CULLHULL_GPU_TESTS=short "$sanitizer" --tool "$tool" \
      --error-exitcode 9 "${launcher[@]}" "$root/bin/gpu_tests" --gtest_filter="$suite.*" --gtest_brief=1
    [[ $outcome == left-out ]] || echo "$outcome $job" >>"$done_file"
  done
}

# LIMIT NAME FILE COMMAND...: a program that measures and appends a line to FILE for each figure. It
# ends by itself before its limit, where nothing hangs. The lines are in the summary, too.
figures() {
  local limit name=$2 file=$3
  limit=$(least "$1" "$(left)")
  shift 3
  step "$limit" "$name" "$@" --out "$file" --seconds $((limit * 4 / 5))
  [[ ! -f $file ]] || cat "$file" >>"$summary"
}

run_passes() {
  figures "$passes_seconds" passes "$results/gpu-passes-$date.jsonl" "${launcher[@]}" "$root/bin/gpu_passes"
  record_device "after passes"
}

run_bench() {
  figures "$bench_seconds" bench "$results/gpu-bench-$date.jsonl" "${launcher[@]}" "$root/bin/gpu_bench"
  record_device "after bench"
}

run_scaling() {
  figures "$scaling_seconds" scaling "$results/cpu-scaling-$date.jsonl" "${launcher[@]}" "$root/bin/scaling_bench" \
    --threads 1,2,4,8,16
}

wants() { [[ ,$only, == *",$1,"* ]]; }

# WORD ALLOWED...: every part of the list WORD is among the others.
check_list() {
  local word allowed=" ${*:2} "
  for word in ${1//,/ }; do
    [[ $allowed == *" $word "* ]] || fail 2 "unknown: $word; there are$allowed"
  done
}

run() {
  local all_tools="memcheck racecheck initcheck synccheck"
  local parts="changed passes ncu hulls tests python bench scaling cpu recipes sanitizer"
  local only="" bundle="" words="$0 run $*" seconds=360 part sanitized=all
  results="" tools="" only_suites="" done_before=""
  while (($#)); do
    case "$1" in
      --only | --call | --tool | --suite | --done | --seconds | --results)
        (($# > 1)) || fail 2 "$1 needs a value"
        ;;&
      --only) only=$2 && shift ;;
      --call)
        case "$2" in
          1) only=changed,passes,ncu,hulls,tests,python,sanitizer sanitized=changed tools=memcheck,racecheck ;;
          2) only=bench,scaling,cpu,recipes,sanitizer ;;
          *) fail 2 "there are calls 1 and 2" ;;
        esac
        shift
        ;;
      --tool) tools=$2 && shift ;;
      --suite) only_suites=$2 && shift ;;
      --done) done_before=$2 && shift ;;
      --seconds) seconds=$2 && shift ;;
      --results) results=$2 && shift ;;
      -*) fail 2 "unknown option $1" ;;
      *) bundle=$1 ;;
    esac
    shift
  done
  [[ $seconds =~ ^[1-9][0-9]*$ ]] || fail 2 "--seconds needs a number"
  [[ -z $done_before || -f $done_before ]] || fail 2 "there is no file $done_before"
  # Who names a tool wants that.
  : "${only:=${tools:+sanitizer}}"
  : "${only:=${parts// /,}}" "${tools:=${all_tools// /,}}"
  # shellcheck disable=SC2086
  check_list "$only" $parts
  # shellcheck disable=SC2086
  check_list "$tools" $all_tools
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
  while [[ -e $results/gpu-check-$date.txt ]]; do # an earlier call's in this second
    sleep 0.2
    date=$(date -u +%Y%m%d-%H%M%S)
  done
  log=$results/gpu-check-$date.log summary=$results/gpu-check-$date.txt
  done_file=$results/gpu-check-done.txt
  : "${done_before:=$done_file}"
  {
    echo "date $(date -u +%Y-%m-%dT%H:%M:%SZ)"
    echo "command $words"
    cat "$root/about.txt"
  } | tee "$summary"
  : >"$log"
  trap cut_off TERM INT HUP
  record_cpu
  find_launcher
  no_device=""
  for part in $parts; do
    if [[ $part != scaling && $part != cpu ]] && wants "$part"; then
      find_device
      break
    fi
  done
  # What gives figures comes first: a call may be cut off.
  for part in $parts; do
    wants "$part" || continue
    if [[ -n $no_device && $part != scaling && $part != cpu ]]; then
      note "LEFT OUT: no device  $part"
    else
      "run_$part"
    fi
  done
  [[ -z $no_device ]] || fail 5 "no CUDA device that can be used: $no_device"
  ((failures == 0)) || fail 1 "$failures steps failed; see $log"
  echo "$me: all passed; results in $results"
}

case "${1:-}" in
  stage | run)
    "$@"
    ;;
  *) fail 2 "usage: $0 stage [BUNDLE.tar.gz] | run [--call 1|2] [--only PART,...] [--tool TOOL,...] [--suite SUITE,...] [--done FILE] [--seconds T] [--results FOLDER] [BUNDLE.tar.gz]" ;;
esac
