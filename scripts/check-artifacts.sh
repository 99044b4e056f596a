#!/usr/bin/env bash
# Installs what scripts/artifacts.sh has put into build/dist into empty systems and runs it there:
#   scripts/check-artifacts.sh         in Debian 11, 12, 13 and testing without a compiler, which
#                                      debootstrap makes in build/roots (as root, with a mirror);
#                                      ROOTS="bookworm bullseye" names others. The static programs also
#                                      in a folder with nothing else, that for Windows in an empty
#                                      prefix of wine, what is for ARM by qemu, where these are
#                                      installed; the sources in a root that has what they need
#   scripts/check-artifacts.sh --here  without root and network: what can be run on this machine
#   scripts/check-artifacts.sh --rebuild  builds the commit again, in another folder and without
#                                      ccache, and compares what is for this system byte by byte
# Every artifact must give the hull of data/autzen-150k.ply, as JSON, bit for bit alike, also of the
# same points as .gz, .zst and .npz, certify it, and give their triangulation; PROGRAM names the built
# program that says how they are. Exit status 77: nothing to check, or not here.
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
# same NAME FILE [EXPECTED]: FILE is the hull, or what else the built program found.
same() {
  checks=$((checks + 1))
  if cmp -s "$2" "${3:-$scratch/expected.json}"; then
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
statics=("$dist/cullhull-$version"-linux-*)
wheels=("$dist/cullhull-$version"-*manylinux*"$(uname -m)".whl)
foreign=() # wheels for another processor or C library
for file in "$dist/cullhull-$version"-*linux*.whl; do
  [[ " ${wheels[*]} " == *" $file "* ]] || foreign+=("$file")
done
exe=$dist/cullhull-$version-windows-x86_64.exe
# find_launch FILE: sets `launch`, which runs it. False where that is not installed.
find_launch() {
  launch=()
  [[ $1 != *"$(uname -m)"* ]] || return 0
  launch=(qemu-aarch64-static)
  command -v "${launch[0]}" >/dev/null || { echo "left out: no ${launch[0]} for ${1##*/}" && false; }
}
debs=("$dist"/*cullhull*_"$version"_*.deb)
[[ -e $static || ${#wheels[@]} -gt 0 || ${#debs[@]} -gt 0 ]] ||
  give_up "build/dist has no artifact of $version (make static, wheel, deb)"
[[ -x $program ]] || program=$static
[[ -x $program ]] || give_up "no built program to compare with (make build)"
"$program" hull "$points" -q -o "$scratch/expected.json"
"$program" delaunay "$points" -q -o "$scratch/cells.json"

# The same points in every way that a library of its own reads.
inputs=$scratch/inputs
mkdir "$inputs"
cp "$points" "$inputs/points.ply"
gzip -c "$points" >"$inputs/points.ply.gz"
zstd -q -c "$points" >"$inputs/points.ply.zst" || give_up "no zstd (scripts/install-deps.sh roots)"
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
  "$@" certify "$points" "$scratch/expected.json" >/dev/null || broken "$name: certify"
  "$@" info "$points" >/dev/null || broken "$name: info"
  rm -f "$scratch/found.json"
  "$@" delaunay "$points" -q -o "$scratch/found.json" || true
  same "$name, delaunay" "$scratch/found.json" "$scratch/cells.json"
}

# Builds all that build/dist holds a second time: the same commit, another folder.
rebuild() {
  [[ -z $(git status --porcelain --untracked-files=no) ]] || give_up "there are uncommitted changes"
  local again=$scratch/again kinds=() file
  [[ ! -e $static ]] || kinds+=(static)
  [[ ${#wheels[@]} -le 1 ]] || kinds+=(wheels)
  [[ ${#wheels[@]} -ne 1 ]] || kinds+=(wheel)
  [[ ! -e $dist/cullhull-$version.tar.gz ]] || kinds+=(sdist)
  [[ ${#debs[@]} -eq 0 ]] || kinds+=(deb)
  git clone --quiet --no-hardlinks . "$again"
  mkdir -p "$again/build" && cp -r build/sysroot "$again/build/"
  echo "building again: ${kinds[*]}"
  CCACHE_DISABLE=1 "$again/scripts/artifacts.sh" "${kinds[@]}" >"$scratch/log" 2>&1 ||
    broken "the second build: $(tail -n 3 "$scratch/log")"
  for file in "$again"/build/dist/*; do
    checks=$((checks + 1))
    if cmp -s "$file" "$dist/$(basename "$file")"; then
      echo "ok    the same bytes again: $(basename "$file")"
    else
      echo "WRONG other bytes: $(basename "$file")"
      failures=$((failures + 1))
      [[ -z ${KEEP:-} ]] || { mkdir -p "$KEEP" && cp "$file" "$KEEP"; }
    fi
  done
}

here() {
  local file launch
  for file in "${statics[@]}"; do
    find_launch "$file" || continue
    hulls "static program, ${file##*-}" "${launch[@]}" "$file"
    checks=$((checks + 1))
    "${launch[@]}" "$file" --licenses >"$scratch/licences"
    grep -q '^==== LGPL-2.1 (glibc) ====' "$scratch/licences" || broken "no licences in $file"
  done
  if [[ -e $exe ]] && command -v wine >/dev/null; then
    hulls "program for Windows" env -u DISPLAY -u WAYLAND_DISPLAY "WINEPREFIX=$scratch/wine" \
      WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml,winemenubuilder.exe=' wine "$exe"
  fi
  for wheel in "${wheels[@]}" "${foreign[@]}"; do
    find_launch "$wheel" && [[ ${#launch[@]} -eq 0 || $wheel != *manylinux* ]] || continue # those by try_foreign
    mkdir "$scratch/wheel" && python3 -m zipfile -e "$wheel" "$scratch/wheel"
    chmod +x "$scratch/wheel/cullhull/bin/cullhull"
    hulls "program of $(basename "$wheel")" "${launch[@]}" "$scratch/wheel/cullhull/bin/cullhull"
    checks=$((checks + 1))
    cmp -s packaging/THIRD-PARTY.txt \
      "$scratch"/wheel/cullhull-*.dist-info/licenses/packaging/THIRD-PARTY.txt ||
      broken "no licences in $wheel"
    grep -q '^License-Expression: MIT$' "$scratch"/wheel/cullhull-*.dist-info/METADATA ||
      broken "no SPDX expression in $wheel"
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
      grep -q '^==== BSD-3-Clause (zstd' "$name/copyright" 2>/dev/null || broken "no licences in $name"
    done
    if command -v lintian >/dev/null; then
      checks=$((checks + 1))
      if lintian --allow-root --fail-on error "${debs[@]}" >"$scratch/log" 2>&1; then
        echo "ok    lintian"
      else
        echo "WRONG lintian:" && grep '^E:' "$scratch/log"
        failures=$((failures + 1))
      fi
    fi
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
# within NAME ROOT COMMAND: at most ten minutes, or `limit` seconds, its output shown where it fails.
within() {
  local name=$1 folder=$2 before=$SECONDS
  shift 2
  checks=$((checks + 1))
  if inside "$folder" timeout "${limit:-600}" bash -c "$*" >"$scratch/log" 2>&1; then
    echo "ok    $name: $((SECONDS - before)) s"
  else
    echo "WRONG $name:" && tail -n 5 "$scratch/log"
    failures=$((failures + 1))
  fi
}

# try_alone FILE: a static program in a root that has nothing else.
try_alone() {
  local folder=$scratch/alone-${1##*-} name="static program alone, ${1##*-}" input launch
  find_launch "$1" || return 0
  mkdir -p "$folder/tmp"
  cp "$inputs"/* "$scratch/expected.json" "$folder"
  cp "$1" "$folder/cullhull"
  [[ ${#launch[@]} -eq 0 ]] || cp "$(command -v "${launch[0]}")" "$folder"
  alone() { chroot "$folder" "${launch[@]/#//}" /cullhull "$@" >"$scratch/log" 2>&1; }
  for input in "${names[@]}"; do
    rm -f "$folder/hull.json"
    alone hull "/$input" -q -o /hull.json || true
    same "$name: hull of $input" "$folder/hull.json"
  done
  alone certify /points.ply /expected.json || broken "$name: certify"
  alone info /points.ply || broken "$name: info"
  alone delaunay /points.ply -q -o /cells.json || true
  same "$name: delaunay" "$folder/cells.json" "$scratch/cells.json"
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
  within "$name: certify, info" "$folder" "$* certify /check/points.ply /check/hull.json &&
    $* info /check/points.ply"
  within "$name: delaunay" "$folder" "$* delaunay /check/points.ply -q -o /check/cells.json"
  same "$name: its cells" "$folder/check/cells.json" "$scratch/cells.json"
}

# What debootstrap makes a release with; those it does not know yet are made as unstable is.
debootstrap_script() {
  local known=/usr/share/debootstrap/scripts/$1
  if [[ -e $known ]]; then echo "$known"; else echo /usr/share/debootstrap/scripts/sid; fi
}

prepare() { # prepare CODENAME: an empty root with Python, and what is to be installed
  local folder=$root/build/roots/$1
  if [[ ! -e $folder/complete ]]; then
    rm -rf "$folder" && mkdir -p "$folder"
    debootstrap --variant=minbase --include=ca-certificates,python3,python3-pip,python3-venv "${1%-sdist}" "$folder" \
      "$mirror" "$(debootstrap_script "${1%-sdist}")" >"$folder.log" 2>&1 || give_up "no $1 from $mirror ($folder.log)"
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

# What an installed package must do, also on a thread with the least stack that docs/machines.md names.
use='
import cullhull, numpy, threading
points = numpy.floor(30 * cullhull.generate("cube", 2000, 3)) # without numpy.random, which needs zlib
def run():
    hull = cullhull.convex_hull(points)
    assert cullhull.certify(points, hull).valid, hull
    done.append(len(hull.vertices))
done = []
run()
threading.stack_size(128 << 10)
thread = threading.Thread(target=run)
thread.start(), thread.join()
assert len(done) == 2, done
try:  # this exception passes through a frame of glibc (std::call_once)
    cullhull.convex_hull(numpy.empty((0, 3))).contains([0.0, 0.0, 0.0])
except ValueError:
    print("package used")'

# python_of PLATFORM TAG: sets `python`, its version, and `launch`, which runs that Python for that
# system: Debian's for ARM, or for musl one that is built here of Debian's sources, as Debian has
# none. False for others.
python_of() {
  local platform=$1 tag=$2 machine=aarch64 debian=arm64 codename folder package
  case $tag in
    cp39) python=3.9 codename=bullseye ;;
    cp311) python=3.11 codename=bookworm ;;
    cp312) python=3.13 codename=trixie ;;
    *) return 1 ;;
  esac
  mkdir -p build/roots
  folder=$(realpath build/roots)/$platform-$python # which the Python itself names
  launch=(qemu-aarch64-static -L "$folder" "$folder/usr/bin/python$python")
  [[ $platform != *x86_64 ]] || machine=x86_64 debian=amd64 launch=("${launch[3]}")
  [[ ${#launch[@]} -eq 1 ]] || command -v "${launch[0]}" >/dev/null || return 1
  [[ ! -e $folder/complete ]] || return 0
  [[ $platform == many* ]] || command -v $machine-linux-gnu-gcc >/dev/null || return 1
  rm -rf "$folder" && mkdir -p "$folder/made" && pushd "$folder/made" >/dev/null
  if [[ $platform == manylinux* ]]; then
    fetch_deb "$debian" "$codename" install --download-only -y --no-install-recommends \
      -o "Dir::Cache::archives=$PWD" "python$python" libstdc++6 # that of NumPy
    [[ $codename == bullseye ]] || ln -s usr/lib "$folder/lib"
    for package in *.deb; do dpkg -x "$package" "$folder"; done
  else
    (musl_python) >log 2>&1 || give_up "no Python for $platform: $(tail -n 1 log)"
  fi
  popd >/dev/null
  rm -rf "$folder/made" && touch "$folder/complete"
}
# fetch_deb ARCHITECTURE CODENAME APT-GET-COMMAND...: into the working directory.
fetch_deb() {
  local keys=/usr/share/keyrings/debian-archive-keyring.gpg
  ARCHITECTURE=$1 "$root/scripts/apt-fetch.sh" "lists-$2" "$(printf '%s [signed-by=%s] %s %s main\n' \
    deb $keys "$mirror" "$2" deb-src $keys "$mirror" "$2")" "${@:3}" || give_up "$mirror has not given: ${*:4}"
}
# Debian's sources of `python`, compiled against the musl of Debian 13, which becomes a part of
# `folder`. For ARM by the Python that is built of them for x86-64.
musl_python() {
  local specs=$folder/usr/lib/$machine-linux-musl/musl-gcc.specs flags=-O1 native=()
  fetch_deb $debian trixie download musl musl-dev musl-tools
  for package in *.deb; do dpkg -x "$package" "$folder"; done
  ln -s usr/lib "$folder/lib"
  sed -i "s#/usr/#$folder/usr/#g" "$specs"
  if [[ $machine == x86_64 ]]; then
    sed -i "s#/lib/ld-musl#$folder&#" "$specs"
  else
    (cd "$root" && python_of musllinux_1_2_x86_64 "$tag") || return 1
    PATH=${folder/aarch64/x86_64}/usr/bin:$PATH
    # GCC's libraries for atomic numbers are glibc's.
    flags+=" -mno-outline-atomics"
    native=(--build=x86_64-linux-musl --host=aarch64-linux-musl --with-build-python --disable-ipv6
      ac_cv_file__dev_ptmx=yes ac_cv_file__dev_ptc=no ac_cv_libatomic_needed=no
      READELF=aarch64-linux-gnu-readelf)
  fi
  fetch_deb $debian $codename source --download-only "python$python"
  tar xf "python$python"_*.orig.tar.?z --strip-components=1
  # Neither Debian's name of this system nor its headers and libraries, which are of glibc.
  sed -i 's/MULTIARCH=$($CC --print-multiarch.*/MULTIARCH=/' configure
  [[ ! -e setup.py ]] || sed -i 's/def add_multiarch_paths(self):/&\n        return/' setup.py
  ./configure --prefix=/usr --without-ensurepip --disable-test-modules PKG_CONFIG=false \
    CFLAGS="$flags" CC="$machine-linux-gnu-gcc -specs $specs" "${native[@]}" &&
    make -j "$(nproc)" && make DESTDIR="$folder" install
}
# try_foreign WHEEL: pip takes it and NumPy for that system, and a Python of that system uses them.
try_foreign() {
  local name=${1##*/} platform=${1##*-} tag python launch
  platform=${platform%.whl} tag=${name#"cullhull-$version-"} tag=${tag%%-*}
  python_of "$platform" "$tag" || { echo "left out: no Python for $name" && return; }
  python3 -m venv "$scratch/venv" && rm -rf "$scratch/site"
  "$scratch/venv/bin/pip" install --quiet --target "$scratch/site" --python-version "$python" \
    --only-binary :all: --platform "$platform" --platform "${platform/2_31/2_28}" \
    --platform "${platform/2_31/2_17}" --platform "${platform/1_2/1_1}" "$1"
  PYTHONPATH=$scratch/site "${launch[@]}" -c "$use" >"$scratch/log" 2>&1 || cat "$scratch/log"
  same "$name: import cullhull, by Python $python" "$scratch/log" <(echo "package used")
  [[ $platform != many* ]] || hulls "program of $name" "${launch[@]:0:3}" "$scratch/site/cullhull/bin/cullhull"
}
# The sources: pip compiles them where what docs/install.md names for this is installed.
try_sdist() {
  local folder=$root/build/roots/bookworm-sdist tree=cullhull-$version pip=""
  rm -rf "$folder"
  prepare bookworm-sdist
  [[ ! -e $folder/check/certificates ]] || pip="PIP_CERT=/check/certificates" # also of what it starts
  limit=3600 within "sdist: pip install" "$folder" "cd /check && tar xf $tree.tar.gz && apt-get update &&
    $tree/scripts/install-deps.sh build python && python3 -m venv venv &&
    $pip venv/bin/pip install $tree.tar.gz"
  within "sdist: import cullhull" "$folder" "/check/venv/bin/python -c '$use'"
  inside_hulls "sdist: its program" "$folder" /check/venv/bin/cullhull
}

# What windows.sh has built: DLL and wheel, the latter in a Python of Windows.
try_windows() {
  [[ -e $exe ]] && command -v wine >/dev/null || return 0
  checks=$((checks + 1))
  cmp -s "build/windows/dist/${exe##*/}" "$exe" && PROGRAM=$program scripts/windows.sh package >"$scratch/log" 2>&1 ||
    { broken "DLL and wheel for Windows:" && tail -n 5 "$scratch/log" && return; }
  echo "ok    DLL and wheel for Windows: $(grep '^package:' "$scratch/log")"
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
    # As the README says it: Debian's pip installs into an environment alone (PEP 668).
    within "$codename: pip install $wheel" "$folder" "cd /check && rm -rf venv &&
      python3 -m venv venv && venv/bin/pip install $pip $wheel"
    inside_hulls "$codename: the wheel's program" "$folder" /check/venv/bin/cullhull
    within "$codename: import cullhull" "$folder" "/check/venv/bin/python -c '$use'"
    if [[ $codename == bookworm ]]; then
      inside "$folder" apt-get -qq update >/dev/null 2>&1 || true
      within "$codename: pipx install $wheel" "$folder" "apt-get install -y --no-install-recommends \
        pipx && pipx install --force ${pip:+--pip-args='$pip'} /check/$wheel &&
        /root/.local/bin/cullhull --version"
    fi
  elif [[ ${#wheels[@]} -gt 0 ]]; then # the module is of another Python, but not the program
    wheel=$(basename "${wheels[0]}")
    within "$codename: $wheel unpacked" "$folder" "rm -rf /check/wheel &&
      python3 -m zipfile -e /check/$wheel /check/wheel && chmod +x /check/wheel/cullhull/bin/cullhull"
    inside_hulls "$codename: the wheel's program" "$folder" /check/wheel/cullhull/bin/cullhull
  fi
  if [[ $codename != bullseye && ${#debs[@]} -gt 0 ]]; then
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

case "${1:-}" in
  --here) here ;;
  --rebuild) rebuild ;;
  "")
    [[ $(id -u) -eq 0 ]] || give_up "a root is made as root (--here needs none)"
    command -v debootstrap >/dev/null || give_up "no debootstrap (scripts/install-deps.sh roots)"
    here
    for file in "${statics[@]}"; do try_alone "$file"; done
    for file in "${foreign[@]}"; do try_foreign "$file"; done
    [[ ! -e $dist/cullhull-$version.tar.gz ]] || try_sdist
    try_windows
    for codename in ${ROOTS:-bookworm bullseye trixie testing}; do
      try_root "$codename"
    done
    ;;
  *)
    sed -n '2,16s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
echo "check-artifacts: $checks checks, $failures failed"
[[ $failures -eq 0 ]]
