#!/usr/bin/env bash
# Installs what scripts/artifacts.sh has put into build/dist into empty systems and runs it there:
#   scripts/check-artifacts.sh         in a Debian 12 and a Debian 11 root without a compiler, which
#                                      debootstrap makes in build/roots (as root, with a mirror)
#   scripts/check-artifacts.sh --here  without root and network: what can be run on this machine
# Every artifact must give the hull of data/autzen-150k.ply, as JSON, bit for bit alike, also of the
# same points as .gz, .zst and .npz; PROGRAM names the built program that says how it is. Exit
# status 77: nothing to check, or not here.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
dist=$root/build/dist
mirror=${CULLHULL_MIRROR:-http://deb.debian.org/debian}
version=$(sed -n 's/^#define CULLHULL_VERSION "\(.*\)"$/\1/p' include/cullhull/version.hpp)
program=${PROGRAM:-$root/build/release/bin/cullhull}
points=$root/data/autzen-150k.ply
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failures=0 checks=0

give_up() {
  echo "check-artifacts: $*" >&2
  exit 77
}
# same NAME FILE: FILE is the hull that the built program found.
same() {
  checks=$((checks + 1))
  if cmp -s "$2" "$scratch/expected.json"; then
    echo "ok    $1"
  else
    echo "WRONG $1"
    failures=$((failures + 1))
  fi
}
broken() {
  checks=$((checks + 1)) failures=$((failures + 1))
  echo "WRONG $1"
}

static=$dist/cullhull-$version-linux-$(uname -m)
shopt -s nullglob
wheels=("$dist/cullhull-$version"-*.whl)
debs=("$dist"/*cullhull*_"$version"_*.deb)
[[ -e $static || ${#wheels[@]} -gt 0 || ${#debs[@]} -gt 0 ]] ||
  give_up "build/dist has no artifact of $version (make static, wheel, deb)"
[[ -x $program ]] || program=$static
[[ -x $program ]] || give_up "no built program to compare with (make build)"
"$program" hull "$points" -q -o "$scratch/expected.json"

# The same points in every way that a library of its own reads.
inputs=$scratch/inputs
mkdir "$inputs"
cp "$points" "$inputs/points.ply"
gzip -c "$points" >"$inputs/points.ply.gz"
zstd -q -c "$points" >"$inputs/points.ply.zst" || give_up "no zstd (scripts/install-deps.sh package)"
"$program" cull "$points" -q --cull none --points "$scratch/points.npy"
python3 -m zipfile -c "$inputs/points.npz" "$scratch/points.npy" # deflated
names=(points.ply points.ply.gz points.ply.zst points.npz)
# hulls NAME COMMAND...: of every input.
hulls() {
  local input name=$1
  shift
  for input in "${names[@]}"; do
    rm -f "$scratch/hull.json"
    "$@" hull "$inputs/$input" -q -o "$scratch/hull.json" || true
    same "$name, $input" "$scratch/hull.json"
  done
}

here() {
  if [[ -e $static ]]; then
    hulls "static program" "$static"
  fi
  for wheel in "${wheels[@]}"; do
    mkdir "$scratch/wheel" && python3 -m zipfile -e "$wheel" "$scratch/wheel"
    chmod +x "$scratch/wheel/cullhull/bin/cullhull"
    hulls "program of $(basename "$wheel")" "$scratch/wheel/cullhull/bin/cullhull"
    rm -rf "$scratch/wheel"
  done
  for deb in "${debs[@]}"; do
    command -v dpkg-deb >/dev/null || continue
    dpkg-deb -x "$deb" "$scratch/deb"
  done
  if [[ -x $scratch/deb/usr/bin/cullhull ]]; then
    hulls "program of the packages" "$scratch/deb/usr/bin/cullhull"
    local library
    library=$(echo "$scratch"/deb/usr/lib/*/libcullhull.so.*.*.*)
    # Nothing of the inside is visible but what inline functions of public headers call, and nothing
    # unloads it.
    local name
    for name in $(nm -DC --defined-only "$library" |
      sed -n 's/.* cullhull::internal::\([a-z]*::\)*\([a-z_]*\)(.*/\2/p' | sort -u); do
      grep -rqw "$name" include/cullhull || broken "libcullhull.so shows its inside: $name"
    done
    readelf -d "$library" | grep -q NODELETE || broken "libcullhull.so can be unloaded"
    if command -v cmake >/dev/null && command -v c++ >/dev/null; then
      checks=$((checks + 1))
      if cmake -S tests/package/consumer -B "$scratch/consumer" \
        "-DCMAKE_PREFIX_PATH=$scratch/deb/usr" >"$scratch/log" 2>&1 &&
        cmake --build "$scratch/consumer" >>"$scratch/log" 2>&1 &&
        LD_LIBRARY_PATH=$(dirname "$library") "$scratch/consumer/consumer" >>"$scratch/log"; then
        echo "ok    a program built against the packages"
      else
        echo "WRONG a program built against the packages:" && tail -n 5 "$scratch/log"
        failures=$((failures + 1))
      fi
    fi
    for name in "$scratch"/deb/usr/share/doc/*; do
      grep -q '^==== zstd-dev' "$name/copyright" 2>/dev/null || broken "no licences in $name"
    done
    [[ -e $scratch/deb/usr/share/man/man1/cullhull-hull.1.gz ||
      -e $scratch/deb/usr/share/man/man1/cullhull-hull.1 ]] || broken "no man page"
  fi
}

# inside ROOT COMMAND...: runs it in the root. A program finds libraries beside it through /proc.
inside() {
  local folder=$1
  shift
  unshare --mount sh -c 'mount -t proc proc "$0/proc" && exec chroot "$0" "$@"' "$folder" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 \
    PIP_DISABLE_PIP_VERSION_CHECK=1 DEBIAN_FRONTEND=noninteractive "$@"
}
# within NAME ROOT COMMAND: at most a minute, its output shown where it fails.
within() {
  local name=$1 folder=$2 before=$SECONDS
  shift 2
  checks=$((checks + 1))
  if inside "$folder" timeout 60 bash -c "$*" >"$scratch/log" 2>&1; then
    echo "ok    $name: $((SECONDS - before)) s"
  else
    echo "WRONG $name:" && tail -n 5 "$scratch/log"
    failures=$((failures + 1))
  fi
}

# inside_hulls NAME ROOT COMMAND...: of every input, in the root.
inside_hulls() {
  local input name=$1 folder=$2
  shift 2
  for input in "${names[@]}"; do
    rm -f "$folder/check/hull.json"
    within "$name" "$folder" "$* hull /check/$input -q -o /check/hull.json"
    same "$name: hull of $input" "$folder/check/hull.json"
  done
}

prepare() { # prepare CODENAME: an empty root with Python, and what is to be installed
  local folder=$root/build/roots/$1
  if [[ ! -e $folder/complete ]]; then
    rm -rf "$folder" && mkdir -p "$folder"
    debootstrap --variant=minbase --include=ca-certificates,python3,python3-pip "$1" "$folder" \
      "$mirror" >"$folder.log" 2>&1 || give_up "no $1 from $mirror ($folder.log)"
    touch "$folder/complete"
  fi
  [[ ! -e $folder/usr/bin/cc && ! -e $folder/usr/bin/g++ ]] || give_up "$folder has a compiler"
  rm -rf "$folder/check" && mkdir "$folder/check"
  cp "$inputs"/* "$folder/check/"
  cp /etc/resolv.conf "$folder/etc/resolv.conf"
  cp "$dist"/* "$folder/check/"
  # Whatever this machine trusts to reach a registry through.
  [[ -z ${PIP_CERT:-} ]] || cp "$PIP_CERT" "$folder/check/certificates"
}

# try_root CODENAME: static and wheel, and the packages where they belong
try_root() {
  local codename=$1 folder=$root/build/roots/$1 pip=""
  prepare "$codename"
  if [[ -e $static ]]; then
    inside_hulls "$codename: static program" "$folder" "/check/$(basename "$static")"
  fi
  local wheel
  wheel=$(wheel_for "$folder")
  if [[ -n $wheel ]]; then
    [[ ! -e $folder/check/certificates ]] || pip="--cert /check/certificates"
    within "$codename: pip install $wheel" "$folder" \
      "pip3 install $pip --target /check/site /check/$wheel"
    inside_hulls "$codename: the wheel's program" "$folder" \
      "PYTHONPATH=/check/site python3 -m cullhull"
    within "$codename: import cullhull" "$folder" "PYTHONPATH=/check/site python3 -c '
import cullhull, numpy
points = numpy.random.default_rng(1).random((1000, 3))
hull = cullhull.convex_hull(points)
assert cullhull.certify(points, hull).valid, hull'"
  elif [[ ${#wheels[@]} -gt 0 ]]; then # the module is of another Python, but not the program
    wheel=$(basename "${wheels[0]}")
    within "$codename: $wheel unpacked" "$folder" "rm -rf /check/wheel &&
      python3 -m zipfile -e /check/$wheel /check/wheel && chmod +x /check/wheel/cullhull/bin/cullhull"
    inside_hulls "$codename: the wheel's program" "$folder" /check/wheel/cullhull/bin/cullhull
  fi
  if [[ $codename == bookworm && ${#debs[@]} -gt 0 ]]; then
    inside "$folder" apt-get -qq update >/dev/null 2>&1 || true
    within "$codename: apt install ./*.deb" "$folder" \
      "apt-get install -y --reinstall --no-install-recommends /check/*.deb"
    inside_hulls "$codename: the packages' program" "$folder" cullhull
  fi
}

wheel_for() { # the wheel that fits the Python of a root
  local tag wheel
  tag=$(inside "$1" python3 -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  for wheel in "${wheels[@]}"; do
    wheel=$(basename "$wheel")
    if [[ $wheel == *-$tag-* || ($wheel == *-cp312-abi3-* && ${tag#cp3} -ge 12) ]]; then
      echo "$wheel"
      return
    fi
  done
}

if [[ ${1:-} == --here ]]; then
  here
else
  [[ $(id -u) -eq 0 ]] || give_up "a root is made as root (--here needs none)"
  command -v debootstrap >/dev/null || give_up "no debootstrap (scripts/install-deps.sh package)"
  here
  try_root bookworm
  try_root bullseye
fi
echo "check-artifacts: $checks checks, $failures failed"
[[ $failures -eq 0 ]]
