#!/usr/bin/env bash
# Builds library, program and tests for another processor, runs them there under qemu-user, and
# holds the hash of every hull that a test computes against this machine's:
#   scripts/cross-check.sh aarch64|s390x [SUITE ...]
#   scripts/cross-check.sh libcxx [SUITE ...]    here, with clang and libc++ (CXX, CXXFLAGS)
#   scripts/cross-check.sh macos [PROCESSOR ...] links library and program for macOS on aarch64 and
#                                                x86_64 by zig, in build/macos. Nothing is run
# SUITE: names of test suites; if none, all of tests/reference, tests/exactness and tests/agreement
# but those of the program (Cli*, which are named where they are wanted) and the longest. Needs a
# Debian with its mirror, g++-PROCESSOR-linux-gnu and qemu-user-static (scripts/install-deps.sh
# cross; zig); no root. Everything lies in build/cross. Exit status 77: not possible here, or with
# CULLHULL_NO_FETCH not without the network. JOBS: how many are compiled and run at once.
set -euo pipefail
cd "$(dirname "$0")/.."
cross=$PWD/build/cross scripts=$PWD/scripts
jobs=${JOBS:-$(nproc)}
mirror=${CULLHULL_MIRROR:-http://deb.debian.org/debian}

give_up() {
  echo "cross-check: $*" >&2
  exit 77
}

oldest_macos=13.0
# is WHAT COMMAND...: says WHAT where the command fails.
is() { "${@:2}" >/dev/null || { echo "WRONG $1" && good=false; }; }
# mach_o FILE PROCESSOR: of that processor and system, with no library but the system's own and GMP in
# it; and each symbol it lacks is one of that library.
mach_o() {
  local headers
  headers=$(llvm-objdump --macho --private-headers "$1")
  local kind=${2/#aarch64/arm64}
  is "$1: processor" grep -qE "^MH_MAGIC_64 +${kind^^} " <<<"${headers^^}"
  is "$1: oldest system" grep -qx " *minos $oldest_macos" <<<"$headers"
  is "$1: libraries" test "$(llvm-objdump --macho --dylibs-used "$1" | grep -v ':$\|/libcullhull\.' |
    sed 's/ (.*//; s/^\s*//')" = /usr/lib/libSystem.B.dylib
  is "$1: symbols that are missing" test -z "$(llvm-nm -m -u "$1" | grep -v '(from libSystem)$')"
  is "$1: GMP" grep -q ' T ___gmpz_init$' <<<"$(llvm-nm --defined-only "$1")"
  echo "$1: $(stat -c %s "$1") bytes, for macOS $oldest_macos and later"
}
macos() {
  local processor folder tree file good=true
  [[ $# -gt 0 ]] || set -- aarch64 x86_64
  command -v llvm-objdump >/dev/null || give_up "no llvm-objdump (scripts/install-deps.sh zig)"
  for processor in "$@"; do
    folder=build/zig/$processor-macos.$oldest_macos tree=build/macos/$processor
    [[ -z ${CULLHULL_NO_FETCH:-} || -e $folder/deps/complete ]] || give_up "no $folder/deps (make macos)"
    scripts/zig.sh "$processor-macos.$oldest_macos" "$tree" "cullhull_app cullhull_shared" \
      -DCULLHULL_SHARED=ON -DCMAKE_CXX_FLAGS_RELEASE=-O0
    for file in "$tree"/bin/cullhull "$tree"/src/shared/libcullhull.*.*.*.dylib; do
      mach_o "$file" "$processor"
    done
  done
  $good
}

processor=${1:-}
case "$processor" in
  aarch64) debian=arm64 ;;
  s390x) debian=s390x ;;
  libcxx) debian= ;;
  macos)
    macos "${@:2}"
    exit
    ;;
  *)
    sed -n '2,14s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
shift
if [[ -n $debian ]]; then
  triplet=$processor-linux-gnu
  launch=("qemu-$processor-static" -L "/usr/$triplet")
  for tool in "$triplet-g++" "${launch[0]}"; do
    command -v "$tool" >/dev/null || give_up "no $tool (scripts/install-deps.sh cross)"
  done
else
  launch=(env)
fi

# Tests of the tree itself, of what is not compiled there, and those that take more than ten seconds
# without an emulator.
left_out='Layers|Mentions|Names|Headers|Sampled|Cli.*|Limits|Qconvex|.*/Rbox|Lrs|RandomRuns|HullQuery'
left_out+='|DegenerateSets|.*CubeCorners|ManyDimensions|OutermostFirst|.*GeneralPosition.*'
left_out+='|SmallPlanarSets|FewPoints|Magnitudes|Engine3D|FlatSets'
programs=(reference_tests exactness_tests agreement_tests)
wanted=("$@")

# Sets `tests`: PROGRAM:SUITE for each suite that is wanted, of this machine's programs.
find_suites() {
  local program suite
  tests=()
  for program in "${programs[@]}"; do
    while read -r suite; do
      if [[ ${#wanted[@]} -gt 0 ]]; then
        [[ " ${wanted[*]} " == *" $suite "* ]] || continue
      elif [[ $suite =~ ^($left_out)$ ]]; then
        continue
      fi
      tests+=("$program:$suite")
    done < <("$cross/native/build/bin/$program" --gtest_list_tests | sed -nE 's/^([^ ]+)\.( .*)?$/\1/p')
  done
  [[ ${#tests[@]} -gt 0 ]] || { echo "cross-check: no such suite: ${wanted[*]}" >&2; exit 2; }
}

# The processor's libraries, and this machine's headers of what is header-only.
make_root() {
  local root=$cross/$processor/root state=$cross/$processor/apt codename path
  [[ -e $root/complete ]] && return
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  rm -rf "$root" "$state"
  mkdir -p "$root" "$state"
  (cd "$state" && ARCHITECTURE=$debian "$scripts/apt-fetch.sh" . \
    "deb [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $codename main" \
    download libgmp-dev libgmp10 libhwy-dev libhwy1 libfmt-dev libfmt9 libgtest-dev zlib1g-dev zlib1g \
    libzstd-dev libzstd1)
  for path in "$state"/*.deb; do dpkg -x "$path" "$root"; done
  for path in /usr/include/{CLI,nlohmann,fast_float} /usr/share/cmake/{CLI11,nlohmann_json} \
    /usr/lib/cmake/FastFloat /usr/share/javascript/three; do
    [[ -e $path ]] || give_up "no $path (scripts/install-deps.sh build)"
    mkdir -p "$root$(dirname "$path")" && cp -rL "$path" "$root$path"
  done
  touch "$root/complete"
}

build() { # build NAME CMAKE-OPTIONS...: the tests
  local tree=$cross/$1/build
  mkdir -p "$cross"
  cmake -S . -B "$tree" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS_RELEASE=-O1 \
    -DCULLHULL_FAST_BUILD=ON -DCULLHULL_BUILD_EXAMPLES=OFF -DCULLHULL_BUILD_BENCH=OFF \
    -DCULLHULL_RECORD_HULLS=ON "${@:2}" >"$cross/$1.configured"
  cmake --build "$tree" -j "$jobs" --target cullhull_app "${programs[@]}"
}

# run NAME: all suites of a build, at most $jobs at once; what they say, and every hull they compute.
run() {
  local tree=$cross/$1/build results=$cross/$1/results test
  rm -rf "$results" && mkdir -p "$results"
  printf '%s\n' "${tests[@]}" | xargs -P "$jobs" -I{} bash -c '
    test=$1 bin=$2 suite=${1#*:} results=$3/${1//\//_}
    shift 3
    CULLHULL_RECORD=$results.hulls "$@" "$bin/${test%%:*}" "--gtest_filter=$suite.*" >"$results.log" 2>&1
    echo "$?" >"$results.status"' _ {} "$tree/bin" "$results" "${@:2}" || true
}

summary() { # summary NAME: counts over all logs; false where a test failed
  local results=$cross/$1/results bad=() test
  for test in "${tests[@]}"; do
    [[ $(cat "$results/${test//\//_}.status") == 0 ]] || bad+=("$test")
  done
  cat "$results"/*.log | awk -v name="$1" '
    /^\[  PASSED  \] / { passed += $4 }
    /^\[  SKIPPED \] [0-9]+ test/ { skipped += $4 }
    /^\[  FAILED  \] [0-9]+ test/ { failed += $4 }
    END { printf "%s: %d tests passed, %d skipped, %d failed", name, passed, skipped, failed }'
  echo ", of ${#tests[@]} suites${bad[*]:+; not ended well: ${bad[*]}}"
  [[ ${#bad[@]} -eq 0 ]]
}

# Libraries whose interfaces name types of the C++ library are built with libc++ too: GoogleTest, of
# its sources (Debian: libgtest-dev), and fmt, whose headers suffice.
build_libcxx() {
  local root=$cross/libcxx/root
  local options=("-DCMAKE_CXX_COMPILER=${CXX:-clang++}"
    "-DCMAKE_CXX_FLAGS=-stdlib=libc++ -DFMT_HEADER_ONLY ${CXXFLAGS:-}")
  [[ -e /usr/src/googletest ]] || give_up "no /usr/src/googletest (scripts/install-deps.sh test)"
  cmake -S /usr/src/googletest -B "$cross/libcxx/googletest" -G Ninja -DBUILD_GMOCK=OFF \
    -DCMAKE_BUILD_TYPE=Release "-DCMAKE_INSTALL_PREFIX=$root" "${options[@]}" >/dev/null
  cmake --build "$cross/libcxx/googletest" -j "$jobs" --target install >/dev/null
  build libcxx -DCULLHULL_WITH_CUDA=OFF "-DCMAKE_PREFIX_PATH=$root" "${options[@]}"
}

build native -DCULLHULL_WITH_CUDA=OFF
find_suites
if [[ -n $debian ]]; then
  make_root
  build "$processor" "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/CrossToolchain.cmake" \
    "-DCULLHULL_CROSS=$processor" "-DCULLHULL_CROSS_ROOT=$cross/$processor/root"
else
  build_libcxx
fi
run native env
run "$processor" "${launch[@]}"

good=true
summary native || good=false
summary "$processor" || good=false
# Vectors of ARM's scalable extension are compiled for the scan that finds extreme points alone: the
# same without them, and with vectors of every length.
scan=$cross/$processor/build/bin/agreement_tests
if [[ $processor == aarch64 && -x $scan ]]; then
  for cpu in cortex-a72 max,sve-default-vector-length={16,32,64,256}; do
    if QEMU_CPU=$cpu "${launch[@]}" "$scan" --gtest_filter='*ColumnsFindTheLeast:*DuplicatesGive*' \
      >"$cross/$processor/scan-$cpu.log" 2>&1; then
      echo "aarch64, $cpu: $(tail -n 1 "$cross/$processor/scan-$cpu.log")"
    else
      echo "aarch64, $cpu: FAILED" && good=false
    fi
  done
fi
python3 scripts/compare_hulls.py "$cross/native/results" "$cross/$processor/results" || good=false
$good
