#!/usr/bin/env bash
# Builds what runs as WebAssembly with Debian's emscripten, in build/wasm:
#   scripts/wasm.sh [STEP ...]
#   libraries  what is linked: GMP of Debian's source, headers
#   js         the npm package, in build/wasm/js (bindings/js)
# Without STEP: both. Needs scripts/install-deps.sh wasm and a mirror of Debian (CULLHULL_MIRROR); no
# root. Exit status 77: not possible here. JOBS: how many are compiled at once.
set -euo pipefail
cd "$(dirname "$0")/.."
tree=$PWD/build/wasm
root=$tree/root
jobs=${JOBS:-$(nproc)}
mirror=${CULLHULL_MIRROR:-http://deb.debian.org/debian}
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}  # of node-acorn, for a node that is not Debian's

give_up() {
  echo "wasm: $*" >&2
  exit 77
}

# Numbers have some thousand bits: the algorithms for longer ones, most of GMP, are left out.
make_libraries() {
  local codename name long=()
  [[ -e $root/complete ]] && return
  [[ -z ${CULLHULL_NO_FETCH:-} ]] || give_up "no $root (make js)"
  rm -rf "$root" "$tree/sources"
  mkdir -p "$root/include" "$root/lib/cmake/hwy" "$tree/sources/gmp"
  pushd "$tree/sources" >/dev/null
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  "$OLDPWD/scripts/apt-fetch.sh" apt \
    "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $codename main" \
    source --download-only gmp || exit $?
  tar xf gmp_*.orig.tar.?z -C gmp --strip-components=1
  # Debian leaves out GMP's manual, which its makefiles name.
  mkdir -p gmp/doc && touch gmp/doc/Makefile.in
  for name in MUL_TOOM22 DC_DIV_QR DC_DIVAPPR_Q DC_BDIV_QR DC_BDIV_Q HGCD GCD_DC \
    GCDEXT_DC; do long+=("-D${name}_THRESHOLD=MP_SIZE_T_MAX"); done
  long+=(-DMUL_TOOM22_THRESHOLD_LIMIT=30)
  (cd gmp && emconfigure ./configure --disable-assembly --host=none "--prefix=$root" \
    --disable-shared --enable-static CC_FOR_BUILD=gcc "CFLAGS=-Os ${long[*]}" &&
    emmake make -j "$jobs" SUBDIRS="mpn mpz mpq mpf printf scanf rand" install) >gmp.log 2>&1 || {
    tail -n 20 gmp.log >&2
    exit 1
  }
  popd >/dev/null
  cp -rL /usr/include/{hwy,gmpxx.h} "$root/include/"
  # Headers are all that is used of Highway.
  echo 'add_library(hwy::hwy INTERFACE IMPORTED GLOBAL)' >"$root/lib/cmake/hwy/hwy-config.cmake"
  touch "$root/complete"
}

make_js() {
  make_libraries
  cmake -S . -B "$tree/build" -G Ninja "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/CrossToolchain.cmake" \
    -DCULLHULL_CROSS=wasm "-DCULLHULL_CROSS_ROOT=$root" -DCMAKE_BUILD_TYPE=Release \
    "-DCMAKE_CXX_FLAGS_RELEASE=-O2 -DNDEBUG" -DCULLHULL_FAST_BUILD=ON -DCULLHULL_BUILD_IO=OFF \
    -DCULLHULL_BUILD_APPS=OFF -DCULLHULL_BUILD_C=OFF -DCULLHULL_BUILD_TESTS=OFF \
    -DCULLHULL_BUILD_BENCH=OFF -DCULLHULL_BUILD_EXAMPLES=OFF -DCULLHULL_WITH_CUDA=OFF \
    -DCULLHULL_WITH_MPI=OFF >"$tree/configured"
  cmake --build "$tree/build" -j "$jobs" --target cullhull_js_plane cullhull_js_space
  mkdir -p "$tree/js"
  cp bindings/js/*.{js,ts,json,md} "$tree/build/js/"{plane,space}.wasm LICENSE "$tree/js/"
}

[[ $# -gt 0 ]] || set -- libraries js
for tool in emcc node; do
  command -v $tool >/dev/null || give_up "no $tool (scripts/install-deps.sh wasm)"
done
for step in "$@"; do
  case "$step" in
    libraries | js) "make_$step" ;;
    *)
      sed -n '2,8s/^# \{0,1\}//p' "$0" >&2
      exit 2
      ;;
  esac
done
