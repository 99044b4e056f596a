#!/usr/bin/env bash
# Makes a folder to build against, so that what is built runs on any Linux of the last years:
#   scripts/portable-sysroot.sh FOLDER
# It holds the C library of Debian 11 (glibc 2.31), static Highway and fmt built for it from the
# sources of Debian 12, and the other libraries of Debian 12 (the file `versions` lists them). The
# compiler and its C++ library stay this machine's own; cmake/PortableToolchain.cmake points them
# there. Needs a Debian or Ubuntu and a mirror of Debian (CULLHULL_MIRROR names another). Exit status
# 77: not possible here. Does nothing where FOLDER is complete.
set -euo pipefail
folder=$(realpath -m "${1:?usage: scripts/portable-sysroot.sh FOLDER}")
root=$(realpath "$(dirname "${BASH_SOURCE[0]}")/..")
mirror=${CULLHULL_MIRROR:-http://deb.debian.org/debian}
[[ -e $folder/complete ]] && exit 0

give_up() {
  echo "portable-sysroot: $*" >&2
  exit 77
}
[[ $(dpkg --print-architecture 2>/dev/null) == amd64 ]] || give_up "only on Debian and Ubuntu, amd64"

rm -rf "$folder"
mkdir -p "$folder/usr/include" "$folder/download"
cd "$folder/download"

keys=/usr/share/keyrings/debian-archive-keyring.gpg
[[ -e $keys ]] || give_up "no $keys (Debian: debian-archive-keyring)"
fetch() { "$root/scripts/apt-fetch.sh" "$@"; } # fetch NAME "SOURCES LINE" COMMAND...
fetch old "deb [signed-by=$keys] $mirror bullseye main" \
  download libc6 libc6-dev linux-libc-dev libcrypt1 libcrypt-dev libgcc-10-dev
fetch new "deb [signed-by=$keys] $mirror bookworm main" \
  download libgmp10 libgmp-dev zlib1g-dev libzstd-dev libcli11-dev nlohmann-json3-dev \
  libfast-float-dev libjs-three
fetch source "deb-src [signed-by=$keys] $mirror bookworm main" source --download-only highway fmtlib

for package in libc6_* libc6-dev_* linux-libc-dev_* libcrypt1_* libcrypt-dev_*; do
  dpkg -x "$package" "$folder"
done
# Links to absolute paths would lead out of the folder.
find "$folder" -type l | while read -r link; do
  target=$(readlink "$link")
  [[ $target == /* ]] || continue
  ln -sfn "$(realpath -m --relative-to="$(dirname "$link")" "$folder$target")" "$link"
done
# The unwinder of a newer libgcc asks the C library for what only glibc 2.35 has.
dpkg -x libgcc-10-dev_* unwinder
mkdir "$folder/usr/lib/unwinder"
cp unwinder/usr/lib/gcc/x86_64-linux-gnu/10/libgcc*.a "$folder/usr/lib/unwinder"

# This machine's C++ library, whose archive names three things that glibc 2.31 does not have.
ln -s /usr/include/c++ "$folder/usr/include/c++"
ln -s /usr/include/x86_64-linux-gnu/c++ "$folder/usr/include/x86_64-linux-gnu/c++"
cat >compat.c <<'C'
#include <stdint.h>
#include <stdlib.h>
#include <sys/random.h>
#define OURS __attribute__((visibility("hidden")))
OURS char __libc_single_threaded = 0; /* glibc 2.32: that no lock is needed; 0 is always true */
OURS uint32_t arc4random(void) {      /* glibc 2.36 */
  uint32_t value;
  while (getrandom(&value, sizeof value, 0) != sizeof value) {
  }
  return value;
}
OURS unsigned long __isoc23_strtoul(const char* text, char** end, int base) { /* glibc 2.38 */
  return strtoul(text, end, base);
}
C
cc --sysroot="$folder" -O2 -fPIC -c compat.c -o "$folder/usr/lib/compat.o"

# Header-only libraries, GMP (which asks glibc 2.14), zlib, zstd and three.js, as Debian 12 has them.
for package in libgmp10_* libgmp-dev_* zlib1g-dev_* libzstd-dev_* libcli11-dev_* \
  nlohmann-json3-dev_* libfast-float-dev_* libjs-three_*; do
  dpkg -x "$package" libraries
  dpkg-deb --show "$package" >>"$folder/versions"
done
for package in highway fmtlib; do
  file=$(echo "$package"_*.dsc)
  case $package in highway) name=libhwy-dev ;; fmtlib) name=libfmt-dev ;; esac
  printf '%s\t%s\n' "$name" "$(sed -n 's/^Version: //p' "$file" | head -n 1)" >>"$folder/versions"
done
copy() { mkdir -p "$folder$(dirname "$1")" && cp -rL "libraries$1" "$folder$1"; }
for path in /usr/include/{CLI,nlohmann,fast_float} /usr/share/cmake/{CLI11,nlohmann_json} \
  /usr/lib/cmake/FastFloat /usr/include/gmpxx.h /usr/include/x86_64-linux-gnu/gmp.h \
  /usr/lib/x86_64-linux-gnu/libgmp.{a,so,so.10} /usr/share/javascript/three \
  /usr/include/{zlib,zconf,zstd,zstd_errors}.h /usr/lib/x86_64-linux-gnu/lib{z,zstd}.a; do
  copy "$path"
done

build() { # build SOURCE-ARCHIVE CMAKE-OPTIONS...: installed into the folder
  local name=${1%%_*}
  mkdir "$name" && tar xf "$1" -C "$name" --strip-components=1
  cmake -S "$name" -B "$name/build" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_TOOLCHAIN_FILE="$root/cmake/PortableToolchain.cmake" -DCULLHULL_SYSROOT="$folder" \
    -DCMAKE_INSTALL_PREFIX=/usr -DCMAKE_INSTALL_LIBDIR=lib/x86_64-linux-gnu \
    -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DBUILD_SHARED_LIBS=OFF "${@:2}" >"$name.log"
  cmake --build "$name/build" >>"$name.log"
  DESTDIR="$folder" cmake --install "$name/build" >>"$name.log"
}
build highway_*.orig.tar.gz -DHWY_ENABLE_TESTS=OFF -DHWY_ENABLE_EXAMPLES=OFF \
  -DHWY_ENABLE_CONTRIB=OFF -DBUILD_TESTING=OFF
build fmtlib_*.orig.tar.gz -DFMT_TEST=OFF -DFMT_DOC=OFF
# Highway 1.0 installs no CMake package.
mkdir -p "$folder/usr/lib/x86_64-linux-gnu/cmake/hwy"
cat >"$folder/usr/lib/x86_64-linux-gnu/cmake/hwy/hwy-config.cmake" <<'CMAKE'
if(NOT TARGET hwy::hwy)
  add_library(hwy::hwy STATIC IMPORTED)
  set_target_properties(hwy::hwy PROPERTIES
    IMPORTED_LOCATION "${CMAKE_CURRENT_LIST_DIR}/../../libhwy.a")
endif()
CMAKE
cd "$folder"
rm -rf download
touch complete
