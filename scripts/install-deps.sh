#!/usr/bin/env bash
# Installs the packages cullhull is built from: the one list there is (docs/dependencies.md says why
# each). Debian 12, Ubuntu 24.04 and later. Usage: scripts/install-deps.sh [PART ...]
# Parts: build (always included), mpi, test (for make test), test-all, bench, docs, fuzz, format,
# python, package (to build artifacts), roots (to check them), cross, zig (what scripts/zig.sh builds
# libraries with), windows, wasm. Does nothing where nothing is missing; else it says how much
# it will fetch, and calls apt-get as root, or through sudo.
set -euo pipefail

build=(g++ cmake ninja-build ccache pkg-config libhwy-dev libgmp-dev
  libcli11-dev libfmt-dev nlohmann-json3-dev libfast-float-dev libjs-three
  zlib1g-dev libzstd-dev)
mpi=(libopenmpi-dev openmpi-bin)
test=(libgtest-dev qhull-bin lrslib zstd)
test_all=("${test[@]}" "${mpi[@]}" libhdf5-dev libqhull-dev
  libcgal-dev libboost-dev libtbb-dev libbenchmark-dev clang-format clang-tidy)
# Ubuntu's chromium is a snap, which has no package; there the viewer's browser test is skipped.
if grep -qx 'ID=debian' /etc/os-release 2>/dev/null; then
  test_all+=(chromium chromium-driver python3-selenium python3-pil)
fi
bench=(libbenchmark-dev libqhull-dev libcgal-dev libboost-dev libtbb-dev)
docs=(doxygen python3 python3-venv python3-pip)
fuzz=(clang)
format=(clang-format)
python=(python3 python3-dev python3-venv python3-pip)
package=(python3 dpkg-dev file debian-archive-keyring)
roots=(lintian zstd debootstrap debian-archive-keyring qemu-user-static gcc-aarch64-linux-gnu)
cross=(g++-aarch64-linux-gnu g++-s390x-linux-gnu qemu-user-static debian-archive-keyring python3)
zig=(llvm m4 make curl bzip2 xz-utils python3 python3-venv)
# 170 MB to fetch, 1.1 GB on disk.
windows=(g++-mingw-w64-x86-64-posix libz-mingw-w64-dev wine64 wine libgtest-dev
  debian-archive-keyring python3)
wasm=(emscripten node-acorn make debian-archive-keyring python3)

wanted=("${build[@]}")
for part in "$@"; do
  case "$part" in
    build) ;;
    mpi) wanted+=("${mpi[@]}") ;;
    test) wanted+=("${test[@]}") ;;
    test-all) wanted+=("${test_all[@]}") ;;
    bench) wanted+=("${bench[@]}") ;;
    docs) wanted+=("${docs[@]}") ;;
    fuzz) wanted+=("${fuzz[@]}") ;;
    format) wanted+=("${format[@]}") ;;
    python) wanted+=("${python[@]}") ;;
    package) wanted+=("${package[@]}") ;;
    roots) wanted+=("${roots[@]}") ;;
    cross) wanted+=("${cross[@]}") ;;
    zig) wanted+=("${zig[@]}") ;;
    windows) wanted+=("${windows[@]}") ;;
    wasm) wanted+=("${wasm[@]}") ;;
    *)
      echo "install-deps: unknown part '$part'; known: build mpi test test-all bench docs fuzz format python package roots cross zig windows wasm" >&2
      exit 2
      ;;
  esac
done

if ! command -v apt-get >/dev/null || ! command -v dpkg-query >/dev/null; then
  echo "install-deps: no apt-get here; make sure these (Debian names) are installed: ${wanted[*]}" >&2
  exit 0
fi

missing=()
for package in "${wanted[@]}"; do
  status=$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)
  [[ $status == *installed* && $status != *not-installed* ]] || missing+=("$package")
done
[[ ${#missing[@]} -eq 0 ]] && exit 0

if [[ $(id -u) -eq 0 ]]; then
  as_root=(env)
elif command -v sudo >/dev/null; then
  as_root=(sudo env)
else
  echo "install-deps: not root and no sudo; ask for: apt-get install ${missing[*]}" >&2
  exit 1
fi
as_root+=(DEBIAN_FRONTEND=noninteractive)
install=(apt-get install -y --no-install-recommends -o APT::Keep-Downloaded-Packages=false "${missing[@]}")

# The package index of a fresh machine is empty, that of an old one may name files long gone.
if ! "${as_root[@]}" "${install[@]}" --dry-run >/dev/null 2>&1; then
  "${as_root[@]}" apt-get update
fi
sizes=$(LC_ALL=C apt-get install --assume-no --no-install-recommends "${missing[@]}" 2>/dev/null |
  sed -nE 's/^Need to get (.*) of archives.$/\1 to fetch/p; s/^After this operation, (.*) of additional disk space.*/\1 on disk/p' |
  paste -sd, | sed 's/,/, /') || true
echo "install-deps: installing ${missing[*]}${sizes:+ ($sizes)}"
"${as_root[@]}" "${install[@]}" || {
  "${as_root[@]}" apt-get update
  "${as_root[@]}" "${install[@]}"
}
