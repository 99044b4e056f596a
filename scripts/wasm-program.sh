#!/usr/bin/env bash
# Builds the program as a module of WebAssembly with Debian's emscripten, for the page of the
# documentation where a file is dropped (docs/site/try.html): scripts/wasm-program.sh TREE. The
# module is TREE/build/bin/cullhull.wasm, the script that loads it cullhull.js beside it. GMP, zlib
# and fmt are built from Debian's sources (CULLHULL_MIRROR); no root. JOBS: how many sources are
# compiled at once. Exit status 77: not possible here.
set -euo pipefail
tree=$(realpath -m "${1:?usage: scripts/wasm-program.sh TREE}")
cd "$(dirname "$0")/.."
root=$tree/root
jobs=${JOBS:-$(nproc)}
export NODE_PATH=${NODE_PATH:-/usr/share/nodejs}  # of node-acorn, for a node that is not Debian's
mirror=${CULLHULL_MIRROR:-http://deb.debian.org/debian}

for tool in emcc emcmake node; do
  command -v $tool >/dev/null || {
    echo "wasm-program: no $tool (scripts/install-deps.sh interface)" >&2
    exit 77
  }
done

make_libraries() {
  local codename name
  rm -rf "$root" "$tree/sources"
  mkdir -p "$root"/{include,lib/cmake/hwy,share/cmake} "$tree/sources"
  pushd "$tree/sources" >/dev/null
  codename=$(. /etc/os-release && echo "$VERSION_CODENAME")
  "$OLDPWD/scripts/apt-fetch.sh" apt \
    "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $codename main" \
    source --download-only gmp zlib fmtlib || exit $?
  for name in gmp zlib fmtlib; do
    mkdir "$name" && tar xf "$name"_*.orig.tar.?z* -C "$name" --strip-components=1
  done
  # Debian leaves out GMP's manual, which its makefiles name.
  mkdir -p gmp/doc && touch gmp/doc/Makefile.in
  (cd gmp && emconfigure ./configure --disable-assembly --host=none "--prefix=$root" \
    --disable-shared CC_FOR_BUILD=gcc &&
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
  for name in include/{CLI,nlohmann,fast_float,hwy,gmpxx.h} share/cmake/{CLI11,nlohmann_json} \
    lib/cmake/FastFloat; do
    cp -rL "/usr/$name" "$root/$name"
  done
  # Headers are all that is used of Highway.
  echo 'add_library(hwy::hwy INTERFACE IMPORTED GLOBAL)' >"$root/lib/cmake/hwy/hwy-config.cmake"
  touch "$root/complete"
}

[[ -e $root/complete ]] || make_libraries
cmake -S . -B "$tree/build" -G Ninja "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/CrossToolchain.cmake" \
  -DCULLHULL_CROSS=wasm "-DCULLHULL_CROSS_ROOT=$root" -DCMAKE_BUILD_TYPE=Release \
  "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG" -DCULLHULL_FAST_BUILD=ON \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DCULLHULL_BUILD_C=OFF -DCULLHULL_BUILD_TESTS=OFF \
  -DCULLHULL_BUILD_BENCH=OFF -DCULLHULL_BUILD_EXAMPLES=OFF -DCULLHULL_WITH_CUDA=OFF \
  -DCULLHULL_WITH_MPI=OFF -DCULLHULL_WITH_HDF5=OFF \
  -DCULLHULL_THREE_JS=/usr/share/javascript/three/three.min.js >"$tree/configured"
cmake --build "$tree/build" -j "$jobs" --target cullhull_app
