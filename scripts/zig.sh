#!/usr/bin/env bash
# Builds for another system with zig, a clang that brings the C++ library and the system's own for
# each (PyPI: ziglang, installed into build/zig where it is not):
#   scripts/zig.sh TARGET TREE GOALS [CMAKE-OPTION ...]
# TARGET: as zig names it, e.g. aarch64-macos.13.0, x86_64-linux-musl, aarch64-linux-gnu.2.31. The
# libraries are built from source into build/zig/TARGET (scripts/wheel-deps.sh), the targets GOALS
# (one word) into the folder TREE. Exit status 77: not possible here. JOBS: how many sources are
# compiled at once.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${1:?} tree=${2:?} goals=${3:?}
shift 3
mkdir -p build/zig
zigs=$(realpath build/zig) # a clone may share it
folder=$zigs/$target
find_zig() { zig=$(echo "$zigs"/venv/lib/python3*/site-packages/ziglang/zig) && [[ -x $zig ]]; }
find_zig || { python3 -m venv "$zigs/venv" && "$zigs/venv/bin/python" -m pip install -q ziglang==0.17.1 &&
  find_zig; } || {
  echo "zig: PyPI has not given ziglang" >&2
  exit 77
}
export ZIG_GLOBAL_CACHE_DIR=$zigs/cache ZIG_LOCAL_CACHE_DIR=$zigs/cache

# What CMake and configure scripts take for a compiler; as old as it was where it is the same.
mkdir -p "$folder/bin"
for tool in clang clang++ ar ranlib; do
  case $tool in
    clang) words="cc --target=$target" ;;
    clang++) words="c++ --target=$target" ;;
    *) words=$tool ;;
  esac
  printf '#!/bin/sh\nexec "%s" %s "$@"\n' "$zig" "$words" >"$folder/new"
  chmod +x "$folder/new"
  cmp -s "$folder/new" "$folder/bin/$tool" || mv "$folder/new" "$folder/bin/$tool"
done
case $target in
  *-macos*) host=${target%%-*}-apple-darwin ;;
  *) host=$(sed 's/\(gnu\|musl\).*/\1/' <<<"$target") ;;
esac
toolchain=(-G Ninja "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/ZigToolchain.cmake"
  "-DCULLHULL_ZIG=$folder" "-DCULLHULL_ZIG_TARGET=$target")
scripts/wheel-deps.sh "$folder/deps" "$folder/bin" "$host" "${toolchain[@]}"
cmake -S . -B "$tree" "${toolchain[@]}" -DCMAKE_BUILD_TYPE=Release -DCULLHULL_FAST_BUILD=ON \
  -DCULLHULL_BUILD_TESTS=OFF -DCULLHULL_BUILD_BENCH=OFF -DCULLHULL_BUILD_EXAMPLES=OFF \
  -DCULLHULL_WITH_HDF5=OFF -DCULLHULL_WITH_CUDA=OFF -DCULLHULL_WITH_MPI=OFF \
  "-DCULLHULL_THREE_JS=$folder/deps/share/javascript/three/three.min.js" "$@"
# shellcheck disable=SC2086
cmake --build "$tree" -j "${JOBS:-$(nproc)}" --target $goals
