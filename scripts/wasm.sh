#!/usr/bin/env bash
# Builds what runs as WebAssembly with Debian's emscripten, in build/wasm:
#   scripts/wasm.sh [STEP ...]
#   libraries  what is linked: GMP, zlib, fmt and Highway of Debian's sources, headers
#   js         the npm package, in build/wasm/js (bindings/js)
#   program    cullhull.wasm and the script that loads it, in build/wasm/program, for the page of the
#              documentation where a file is dropped (docs/site/try.html)
# Without STEP: all. Needs scripts/install-deps.sh wasm and a mirror of Debian (CULLHULL_MIRROR); no
# root. Exit status 77: not possible here. JOBS: how many are compiled at once.
set -euo pipefail
cd "$(dirname "$0")/.."
tree=$PWD/build/wasm
root=$tree/root
jobs=${JOBS:-$(nproc)}
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}  # of node-acorn, for a node that is not Debian's

give_up() {
  echo "wasm: $*" >&2
  exit 77
}

# Numbers have some thousand bits: the algorithms for longer ones, most of GMP, are left out.
make_libraries() {
  local name long=()
  [[ -e $root/highway-1.2 ]] && return
  [[ -z ${CULLHULL_NO_FETCH:-} ]] || give_up "no $root (scripts/wasm.sh libraries)"
  rm -rf "$root" "$tree"/{sources,build}
  mkdir -p "$root"/{include,lib/cmake/hwy,share/cmake} "$tree/sources"
  pushd "$tree/sources" >/dev/null
  "$OLDPWD/scripts/debian-sources.sh" gmp zlib fmtlib || exit $?
  SUITE=trixie "$OLDPWD/scripts/debian-sources.sh" highway || exit $?
  for name in MUL_TOOM22 DC_DIV_QR DC_DIVAPPR_Q DC_BDIV_QR DC_BDIV_Q HGCD GCD_DC \
    GCDEXT_DC; do long+=("-D${name}_THRESHOLD=MP_SIZE_T_MAX"); done
  long+=(-DMUL_TOOM22_THRESHOLD_LIMIT=30)
  (cd gmp && emconfigure ./configure --disable-assembly --host=none "--prefix=$root" \
    --disable-shared --enable-static CC_FOR_BUILD=gcc "CFLAGS=-Os ${long[*]}" &&
    emmake make -j "$jobs" SUBDIRS="mpn mpz mpq mpf printf scanf rand" install &&
    cd ../zlib && emconfigure ./configure --static "--prefix=$root" &&
    emmake make -j "$jobs" libz.a && cp libz.a "$root/lib" && cp zlib.h zconf.h "$root/include" &&
    cd .. && emcmake cmake -S fmtlib -B fmt -G Ninja -DCMAKE_BUILD_TYPE=Release \
      -DCMAKE_CXX_FLAGS=-fwasm-exceptions -DFMT_TEST=OFF -DFMT_DOC=OFF \
      "-DCMAKE_INSTALL_PREFIX=$root" && cmake --build fmt -j "$jobs" --target install) >log 2>&1 || {
    tail -n 20 log >&2
    exit 1
  }
  popd >/dev/null
  for name in include/{CLI,nlohmann,fast_float,gmpxx.h} share/cmake/{CLI11,nlohmann_json} \
    lib/cmake/FastFloat; do
    cp -rL "/usr/$name" "$root/$name"
  done
  # Headers are all that is used of Highway. Its version 1.0 has no vectors of doubles here.
  cp -r "$tree/sources/highway/hwy" "$root/include/"
  echo 'add_library(hwy::hwy INTERFACE IMPORTED GLOBAL)' >"$root/lib/cmake/hwy/hwy-config.cmake"
  touch "$root/highway-1.2"
}

# build TARGET ...
build() {
  make_libraries
  cmake -S . -B "$tree/build" -G Ninja "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/CrossToolchain.cmake" \
    -DCULLHULL_CROSS=wasm "-DCULLHULL_CROSS_ROOT=$root" -DCMAKE_BUILD_TYPE=Release \
    "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG" -DCULLHULL_FAST_BUILD=ON \
    -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCULLHULL_BUILD_C=OFF -DCULLHULL_BUILD_TESTS=OFF \
    -DCULLHULL_BUILD_BENCH=OFF -DCULLHULL_BUILD_EXAMPLES=OFF -DCULLHULL_WITH_CUDA=OFF \
    -DCULLHULL_WITH_MPI=OFF -DCULLHULL_WITH_HDF5=OFF \
    -DCULLHULL_THREE_JS=/usr/share/javascript/three/three.min.js >"$tree/configured"
  cmake --build "$tree/build" -j "$jobs" --target "$@"
}

make_js() {
  build cullhull_js_plane cullhull_js_space
  mkdir -p "$tree/js"
  cp bindings/js/*.{js,ts,json,md} "$tree/build/js/"{plane,space}.wasm LICENSE "$tree/js/"
}

make_program() {
  build cullhull_app
  mkdir -p "$tree/program"
  cp "$tree/build/bin/"cullhull.{js,wasm} "$tree/program/"
}

[[ $# -gt 0 ]] || set -- libraries js program
for tool in emcc node; do
  command -v $tool >/dev/null || give_up "no $tool (scripts/install-deps.sh wasm)"
done
for step in "$@"; do
  case "$step" in
    libraries | js | program) "make_$step" ;;
    *)
      sed -n '2,10s/^# \{0,1\}//p' "$0" >&2
      exit 2
      ;;
  esac
done
