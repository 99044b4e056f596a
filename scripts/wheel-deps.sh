#!/usr/bin/env bash
# Builds the libraries that a wheel is made with, where no Debian is to take them from (the manylinux
# images, macOS), for .github/workflows/wheels.yml:
#   scripts/wheel-deps.sh PREFIX [TOOLS HOST CMAKE-OPTION ...]
# and for another system (scripts/zig.sh), HOST as configure scripts name it, by clang, clang++, ar
# and ranlib of the folder TOOLS and llvm-nm. Sources, and three.js, come from Debian's archive
# (CULLHULL_MIRROR names another), each held against its SHA-256. GMP becomes a shared library, as the
# wheel ships it as a file that can be replaced, or with TOOLS a static one; all others are static.
# Needs a C++ compiler, make, CMake, curl, tar and m4; does nothing where PREFIX is complete.
set -euo pipefail
prefix=${1:?usage: scripts/wheel-deps.sh PREFIX}
mirror=${CULLHULL_MIRROR:-http://deb.debian.org/debian}
jobs=${JOBS:-$(getconf _NPROCESSORS_ONLN)}
[[ -e $prefix/complete ]] && exit 0
mkdir -p "$prefix"
prefix=$(cd "$prefix" && pwd)
tools=${2:-} host=${3:-$(uname -m)}
cmake=("${@:4}")
if [[ -n $tools ]]; then
  export NM=llvm-nm CC=$tools/clang CXX=$tools/clang++ AR=$tools/ar RANLIB=$tools/ranlib
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

sha256() { if command -v sha256sum >/dev/null; then sha256sum "$1"; else shasum -a 256 "$1"; fi; }
# fetch PATH SHA256: a file of the archive's pool
fetch() {
  curl -fsSL --retry 3 -o "${1##*/}" "$mirror/pool/main/$1"
  [[ $(sha256 "${1##*/}") == "$2 "* ]] || {
    echo "wheel-deps: $1 is not what it was" >&2
    exit 1
  }
}
# source PATH SHA256 NAME: unpacked into the folder NAME
source_of() {
  fetch "$1" "$2"
  mkdir "$3" && tar xf "${1##*/}" -C "$3" --strip-components=1
}
with_cmake() { # with_cmake NAME OPTIONS...
  local name=$1
  shift
  cmake -S "$name" -B "$name/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_INSTALL_PREFIX="$prefix" \
    -DCMAKE_INSTALL_LIBDIR=lib -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_SHARED_LIBS=OFF \
    -DCMAKE_POLICY_VERSION_MINIMUM=3.5 ${cmake[@]+"${cmake[@]}"} "$@"
  cmake --build "$name/build" -j "$jobs"
  cmake --install "$name/build"
}

source_of h/highway/highway_1.0.3.orig.tar.gz 566fc77315878473d9a6bd815f7de78c73734acdcb745c3dde8579560ac5440e highway
with_cmake highway -DHWY_ENABLE_TESTS=OFF -DHWY_ENABLE_EXAMPLES=OFF -DHWY_ENABLE_CONTRIB=OFF \
  -DBUILD_TESTING=OFF
# Highway 1.0 installs no CMake package.
mkdir -p "$prefix/lib/cmake/hwy"
cat >"$prefix/lib/cmake/hwy/hwy-config.cmake" <<'CMAKE'
if(NOT TARGET hwy::hwy)
  get_filename_component(_prefix "${CMAKE_CURRENT_LIST_DIR}/../../.." ABSOLUTE)
  add_library(hwy::hwy STATIC IMPORTED)
  set_target_properties(hwy::hwy PROPERTIES IMPORTED_LOCATION "${_prefix}/lib/libhwy.a"
    INTERFACE_INCLUDE_DIRECTORIES "${_prefix}/include")
endif()
CMAKE
source_of f/fmtlib/fmtlib_9.1.0+ds1.orig.tar.gz 84ce1c2d0be3a9863935137969dcec6970125caac032f82474640bfc81463583 fmt
with_cmake fmt -DFMT_TEST=OFF -DFMT_DOC=OFF
source_of n/nlohmann-json3/nlohmann-json3_3.11.2.orig.tar.gz d69f9deb6a75e2580465c6c4c5111b89c4dc2fa94e3a85fcd2ffcd9a143d9273 json
with_cmake json -DJSON_BuildTests=OFF
source_of f/fast-float/fast-float_3.9.0.orig.tar.gz a10443e13748291709b422b2da49fc6753a1a43bf24205d4600595dfe3d811bb fast_float
with_cmake fast_float -DFASTFLOAT_TEST=OFF
source_of c/cli11/cli11_2.1.2+ds.orig.tar.xz 8143d20b688e98ccce8e24562d3b68e5f47c12e896c42c7ca8553dbde5bed55d cli11
with_cmake cli11 -DCLI11_BUILD_TESTS=OFF -DCLI11_BUILD_EXAMPLES=OFF -DCLI11_BUILD_DOCS=OFF
source_of libz/libzstd/libzstd_1.5.4+dfsg2.orig.tar.xz 8cf4bbb65e77ec348d052c8d6230eba66d435bddf64c8b5be2fcb16880c19953 zstd
make -C zstd/lib -j "$jobs" PREFIX="$prefix" CFLAGS="-O2 -fPIC" install-static install-includes
source_of z/zlib/zlib_1.2.13.dfsg.orig.tar.bz2 71feb7947e3c00ef125f83b79a4e529bde31171e5babe48b391f06758d1ab0a1 zlib
# fdopen: zlib takes every Apple for one without it.
(cd zlib && CFLAGS="-O2 -fPIC -w -Dfdopen=fdopen" ./configure --static --prefix="$prefix" >/dev/null &&
  make -j "$jobs" libz.a >/dev/null && cp libz.a "$prefix/lib/" && cp zlib.h zconf.h "$prefix/include/")
source_of g/gmp/gmp_6.2.1+dfsg1.orig.tar.xz 471b9e463e04362a0124f215afc5f0a4b99caedeeb62634c61bbc12988efa64c gmp
mkdir -p gmp/doc # Debian leaves the manual out
printf 'all install install-am install-data install-exec check clean:\n' >gmp/doc/Makefile.in
options=(--enable-shared --disable-static)
[[ -z $tools ]] ||
  options=(--disable-shared --with-pic "--host=$host" CFLAGS="-O2 -w" CC_FOR_BUILD=cc)
# zig's linker refuses the short branches of GMP's own assembler.
case ${tools:+cross-}$host in
  cross-x86_64*) options+=(--disable-assembly) ;;
  x86_64*) options+=(--enable-fat) ;;
esac
(cd gmp && ./configure --prefix="$prefix" --libdir="$prefix/lib" "${options[@]}" >/dev/null &&
  make -j "$jobs" >/dev/null && make install >/dev/null)
cp gmp/gmpxx.h "$prefix/include/" # what is not inline in it, input and output, we do not use
fetch t/three.js/libjs-three_111+dfsg1-2_all.deb a3824c69224dfe676fa151d2a0ff961b33ea9c80397519a91c0941c1686bba51
mkdir three && (cd three && ar x ../libjs-three_*.deb && tar xf data.tar.*)
mkdir -p "$prefix/share/javascript/three"
cp three/usr/share/javascript/three/three.min.js "$prefix/share/javascript/three/"
touch "$prefix/complete"
