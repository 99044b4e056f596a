#!/usr/bin/env bash
# Builds the fuzzers and runs each for SECONDS: scripts/fuzz.sh SECONDS [TARGET...]
# TARGET is the NAME of fuzz/NAME_fuzz.cpp; without one, all run, one after another on one core.
# New inputs go to build/fuzz/corpus/NAME; what fails is kept as build/fuzz/NAME-crash-*.
set -euo pipefail
cd "$(dirname "$0")/.."

if [[ ! ${1:-} =~ ^[1-9][0-9]*$ ]]; then
  echo "usage: scripts/fuzz.sh SECONDS [TARGET...]" >&2
  exit 2
fi
seconds=$1
shift
targets=("$@")
if [[ ${#targets[@]} -eq 0 ]]; then
  for source in fuzz/*_fuzz.cpp; do
    targets+=("$(basename "$source" _fuzz.cpp)")
  done
fi

cmake --preset fuzz -DCULLHULL_BUILD_APPS=OFF -DCULLHULL_BUILD_EXAMPLES=OFF >/dev/null
cmake --build --preset fuzz -j "${JOBS:-2}" --target "${targets[@]/#/fuzz_}"

status=0
for target in "${targets[@]}"; do
  mkdir -p "build/fuzz/corpus/$target"
  seeds=()
  if [[ -d fuzz/corpus/$target ]]; then seeds=("fuzz/corpus/$target"); fi
  dictionary=()
  if [[ -f fuzz/$target.dict ]]; then dictionary=("-dict=fuzz/$target.dict"); fi
  several=()
  if [[ $target == hdf5 ]]; then several=(-fork=1); fi # a crash of libhdf5 ends a process
  echo "== $target: $seconds s"
  if ! "build/fuzz/bin/fuzz_$target" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 \
    -max_len=4096 -print_final_stats=1 -verbosity=0 -artifact_prefix="build/fuzz/$target-" \
    "${dictionary[@]}" "${several[@]}" "build/fuzz/corpus/$target" "${seeds[@]}" >"build/fuzz/$target.log" 2>&1; then
    tail -n 40 "build/fuzz/$target.log"
    echo "== $target: FAILED (build/fuzz/$target.log)"
    status=1
  else
    grep -E "number_of_executed_units|average_exec_per_sec" "build/fuzz/$target.log" || true
  fi
done
exit $status
