#!/usr/bin/env bash
# Builds for Windows (x86-64) with Debian's MinGW-w64 and runs what is built under its wine:
#   scripts/windows.sh [STEP ...]
#   libraries  what is linked: GMP, zstd and fmt of Debian's sources, GoogleTest, zlib, headers
#   build      cullhull.exe, one file; cullhull.dll with import library, headers and CMake files
#   wheel      the Python package for CPython 3.12 and later (stable ABI)
#   test       the tests of core and io, and those of the program, each under wine
#   package    a project that links the DLL; the wheel in a Python of Windows under wine: pip installs
#              it; its tests and its bytes, beside those of PROGRAM (build/release/bin/cullhull)
#   short      of these what make test-all runs: tests/reference, the program beside Linux's, both
#              compiled at -O1 in a folder of their own
# Without STEP: all but the last, in this order. Everything lies in build/windows, what others get
# in its dist. Needs scripts/install-deps.sh windows and a mirror of Debian (CULLHULL_MIRROR); no
# root.
# Exit status 77: not possible here. JOBS: how many are compiled and run at once.
set -euo pipefail
cd "$(dirname "$0")/.."
version=$(sed -n 's/^#define CULLHULL_VERSION "\(.*\)"$/\1/p' include/cullhull/version.hpp)
tree=$PWD/build/windows
root=$tree/root
sdk=$tree/cullhull-$version-windows-x86_64
build=$tree/build
dist=$tree/dist
jobs=${JOBS:-$(nproc)}
triplet=x86_64-w64-mingw32
cross=("-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/CrossToolchain.cmake" -DCULLHULL_CROSS=windows
  "-DCULLHULL_CROSS_ROOT=$root" -DCMAKE_BUILD_TYPE=Release)
# A prefix of its own, which shows nothing on a display and installs nothing of the network's.
export WINEPREFIX=$tree/wine WINEDEBUG=-all WINEDLLOVERRIDES='mscoree,mshtml,winemenubuilder.exe='
unset DISPLAY WAYLAND_DISPLAY

give_up() {
  echo "windows: $*" >&2
  exit 77
}

make_libraries() {
  local name path
  [[ -e $root/complete ]] && return
  rm -rf "$root" "$tree/sources"
  mkdir -p "$root/include" "$root/lib/cmake/hwy" "$root/share/cmake" "$tree/sources"
  pushd "$tree/sources" >/dev/null
  "$OLDPWD/scripts/debian-sources.sh" gmp libzstd fmtlib || exit $?
  (cd gmp && ./configure --host=$triplet "CC=$triplet-gcc-posix" "--prefix=$root" \
    --disable-shared --enable-static &&
    make -j "$jobs" SUBDIRS="mpn mpz mpq mpf printf scanf rand" install) >gmp.log 2>&1
  build_library libzstd/build/cmake -DZSTD_BUILD_PROGRAMS=OFF -DZSTD_BUILD_SHARED=OFF \
    -DZSTD_LEGACY_SUPPORT=OFF
  build_library fmtlib -DFMT_TEST=OFF -DFMT_DOC=OFF
  build_library /usr/src/googletest -DBUILD_GMOCK=OFF
  popd >/dev/null
  cp /usr/$triplet/include/z{lib,conf}.h "$root/include/"
  cp /usr/$triplet/lib/libz.a "$root/lib/"
  for path in include/{CLI,nlohmann,fast_float,hwy,gmpxx.h} share/cmake/{CLI11,nlohmann_json} \
    lib/cmake/FastFloat; do
    [[ -e /usr/$path ]] || give_up "no /usr/$path (scripts/install-deps.sh build)"
    cp -rL "/usr/$path" "$root/$path"
  done
  # Headers are all that is used of Highway.
  echo 'add_library(hwy::hwy INTERFACE IMPORTED GLOBAL)' >"$root/lib/cmake/hwy/hwy-config.cmake"
  touch "$root/complete"
}

build_library() { # build_library SOURCES CMAKE-OPTIONS...: installed into the root
  local folder=${1//\//_}
  { cmake -S "$1" -B "$folder-build" -G Ninja "${cross[@]}" "-DCMAKE_INSTALL_PREFIX=$root" \
    -DBUILD_SHARED_LIBS=OFF "${@:2}" && cmake --build "$folder-build" -j "$jobs" --target install; \
  } >"$folder.log" 2>&1 || { tail -n 20 "$folder.log" >&2; exit 1; }
}

configure() {
  make_libraries
  cmake -S . -B "$build" -G Ninja "${cross[@]}" "$@" -DCULLHULL_FAST_BUILD=ON \
    -DCULLHULL_SHARED=ON -DCULLHULL_BUILD_EXAMPLES=OFF -DCULLHULL_BUILD_BENCH=OFF \
    -DCULLHULL_TESTS=short -DCULLHULL_WITH_CUDA=OFF -DCULLHULL_WITH_MPI=OFF \
    -DCULLHULL_THREE_JS=/usr/share/javascript/three/three.min.js >"$tree/configured"
}

make_build() {
  configure
  cmake --build "$build" -j "$jobs" --target cullhull_app cullhull_shared
  mkdir -p "$dist"
  $triplet-strip -o "$dist/cullhull-$version-windows-x86_64.exe" "$build/bin/cullhull.exe"
  local name
  rm -rf "$sdk"
  for name in program runtime development; do
    cmake --install "$build" --prefix "$sdk" --component $name >/dev/null
  done
  $triplet-strip "$sdk"/bin/*
  rm -f "$dist/${sdk##*/}.zip"
  (cd "$tree" && cmake -E tar cf "$dist/${sdk##*/}.zip" --format=zip "${sdk##*/}")
  echo "written: $dist/cullhull-$version-windows-x86_64.exe, .zip"
}

# Headers and import library of Windows' Python, which PyPI does not have: this machine's headers,
# sizes of our own, and the names of the stable ABI, of PyPI's list of them.
make_python() { # make_python PYTHON
  local folder=$tree/python venv=$tree/python/venv
  [[ -e $folder/complete ]] && return
  rm -rf "$folder"
  "$1" -m venv "$venv"
  "$venv/bin/pip" install --quiet abi3info 'scikit-build-core>=1.0' 'nanobind>=2.4' 'numpy>=2'
  "$venv/bin/pip" download --quiet --no-deps --only-binary :all: --platform win_amd64 \
    -d "$folder" "numpy==$("$venv/bin/python" -c 'import numpy; print(numpy.__version__)')"
  (cd "$folder" && python3 -m zipfile -e numpy-*.whl .)
  cp -r "$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("include"))')" \
    "$folder/include"
  cat >"$folder/include/pyconfig.h" <<'C'
#define MS_WINDOWS
#define MS_WIN32
#define MS_WIN64
#define NT_THREADS
#define WITH_THREAD 1
#define HAVE_DECLSPEC_DLL
#define Py_ENABLE_SHARED 1
#define SIZEOF_SHORT 2
#define SIZEOF_INT 4
#define SIZEOF_LONG 4
#define SIZEOF_LONG_LONG 8
#define SIZEOF_FLOAT 4
#define SIZEOF_DOUBLE 8
#define SIZEOF_VOID_P 8
#define SIZEOF_SIZE_T 8
#define SIZEOF_WCHAR_T 2
#define SIZEOF_TIME_T 8
#define ALIGNOF_MAX_ALIGN_T 16
C
  "$venv/bin/python" - >"$folder/python3.def" <<'PY'
from abi3info import DATAS, FUNCTIONS
print("LIBRARY python3.dll\nEXPORTS")
for symbols, mark in ((FUNCTIONS, ""), (DATAS, " DATA")):
    for name, about in symbols.items():
        if (about.added.major, about.added.minor) <= (3, 12):
            print(name.name + mark)
PY
  $triplet-dlltool -d "$folder/python3.def" -l "$folder/libpython3.a"
  touch "$folder/complete"
}

make_wheel() {
  local python folder=$tree/python definition settings=()
  for python in python3.{12,13,14} ~/.pyenv/versions/3.1[234].*/bin/python3 ''; do
    [[ -z $python ]] || ! "$python" -c '' 2>/dev/null || break
  done
  [[ -n $python ]] || give_up "no Python 3.12 or later, which the wheel is built with"
  make_python "$python"
  [[ -e $sdk ]] || make_build
  for definition in "CMAKE_TOOLCHAIN_FILE=$PWD/cmake/CrossToolchain.cmake" CULLHULL_CROSS=windows \
    "CULLHULL_CROSS_ROOT=$root;$sdk" "CULLHULL_INSTALLED=$sdk" \
    "Python_EXECUTABLE=$folder/venv/bin/python" "Python_INCLUDE_DIR=$folder/include" \
    "Python_LIBRARY=$folder/libpython3.a" "Python_SABI_LIBRARY=$folder/libpython3.a" \
    "Python_NumPy_INCLUDE_DIR=$folder/numpy/_core/include"; do
    settings+=(--config-settings "cmake.define.$definition")
  done
  PATH="$folder/venv/bin:$PATH" CMAKE_BUILD_PARALLEL_LEVEL=$jobs _PYTHON_HOST_PLATFORM=win-amd64 \
    CPLUS_INCLUDE_PATH=$root/include "$folder/venv/bin/pip" wheel . --quiet --no-deps \
    --no-build-isolation --config-settings "build-dir=$tree/module" "${settings[@]}" \
    --config-settings build.targets=cullhull_python -w "$dist"
  ls "$dist"/*.whl
}

# Left out: tests of the tree itself, and those that take long without an emulator, but which find
# nothing that a system could change.
tree_tests='Layers*:Mentions*:Names*:Headers*:Sampled*:Size*:PublicTypes*'
long_tests='Columns.EveryCombination*:RandomRuns*:DegenerateSets*:*CubeCorners*:ManyDimensions*'
long_tests+=':OutermostFirst*:*GeneralPosition*:SmallPlanarSets*:FewPoints*:Magnitudes*'
long_tests+=':Engine3D*:FlatSets*'

make_test() {
  configure
  local good=true
  run_tests reference exactness agreement || good=false
  program_tests || good=false
  $good
}

make_short() {
  build=$tree/short
  configure -DCMAKE_CXX_FLAGS_RELEASE=-O1
  local good=true
  run_tests reference || good=false
  program_tests || good=false
  $good
}

run_tests() { # run_tests FOLDER...: of tests/
  local name good=true
  cmake --build "$build" -j "$jobs" --target cullhull_app "${@/%/_tests}"
  mkdir -p "$tree/results"
  for name in "$@"; do
    CULLHULL_TEST_SHARE=0.1 wine "$build/bin/${name}_tests.exe" \
      "--gtest_filter=-$tree_tests:$long_tests" >"$tree/results/$name.log" 2>&1 || good=false
    results "$name"
  done
  $good
}

# The program's tests are Linux's, which start it under wine. Left out: what takes long, and
# CliInterrupt, CliMemory, CliStream, Limits  signals, limits of the process, its address space
# CliUsage, CliView, CliOutputs  terminals, which wine draws itself, /dev/null, xdg-open
program_tests() {
  local bin=$PWD/build/release/bin good=true
  if [[ ! -x $bin/cullhull ]]; then
    echo "program: not compared with Linux's, which make build builds"
    return
  fi
  python3 tests/windows/program_test.py "$build/bin/cullhull.exe" "$bin/cullhull" || good=false
  if [[ -x $bin/agreement_tests && $build != */short ]]; then
    printf '#!/bin/sh\nexec wine "%s" "$@"\n' "$build/bin/cullhull.exe" >"$tree/cullhull"
    chmod +x "$tree/cullhull"
    CULLHULL_TESTED_APP=$tree/cullhull CULLHULL_TEST_SHARE=0.1 "$bin/agreement_tests" \
      '--gtest_filter=CliAdvice*:CliColumns*:CliIds*:CliMaps*:CliTables*:CliTriangulation*' \
      >"$tree/results/program.log" 2>&1 || good=false
    results program
  fi
  $good
}

results() { # results NAME: what its log counts
  grep -aE '^\[  (PASSED|SKIPPED|FAILED) ' "$tree/results/$1.log" | sed "s/^/$1: /" ||
    { echo "$1: no result"; good=false; }
}

# The shared library, of which public names alone are exported, as a stranger's project uses it;
# where it is missing, the system's loader names it in one line.
library_test() {
  local place=$tree/consumer
  [[ -e $sdk ]] || make_build
  ! $triplet-objdump -p "$sdk/bin/cullhull.dll" |
    awk '/\[Ordinal.Name/ { on = 1; next } !NF { on = 0 } on { print $NF }' |
    grep -Ev '^_Z(NK?|T[ISV]N)8cullhull([^8]|8[^i]|8internal1[04](free|allocate)_block)' || return 1
  rm -rf "$place"
  cmake -S tests/package/consumer -B "$place" -G Ninja "${cross[@]}" \
    "-DCULLHULL_CROSS_ROOT=$root;$sdk" >/dev/null
  cmake --build "$place" >/dev/null
  cp "$sdk/bin/cullhull.dll" "$place"
  (cd "$place" && wine consumer.exe) || return 1
  rm "$place/cullhull.dll"
  ! (cd "$place" && WINEDEBUG=err+module wine consumer.exe) >"$place/loader" 2>&1 &&
    grep -m 1 -o 'Library cullhull.dll.* not found' "$place/loader"
}

# A Python of Windows, as far as wine 8 goes: CPython's DLLs, which panda3d's wheel brings, and this
# machine's Lib. Without _wmi, and with NumPy 1, as wine lacks what others call (VariantToString,
# crealf). Its standard streams are pipes, as Python wants information that wine has of no file
# which a shell of Unix opened.
windows_python() { (cd "$tree/package" && wine python.exe "$@" </dev/null 2>&1 | cat); }

make_package() {
  local venv=$tree/python/venv place=$tree/package name wheel tests=() good=true
  local program=${PROGRAM:-build/release/bin/cullhull}
  library_test || good=false
  [[ -e $tree/python/complete && -n $(find "$dist" -name '*.whl' 2>/dev/null) ]] || make_wheel
  wheel=$(echo "$dist"/*-win_amd64.whl)
  rm -rf "$place"
  mkdir -p "$place"/{Lib,files} "$tree/results"
  name=$("$venv/bin/python" -c 'import sys; print("python3%d" % sys.version_info[1])')
  "$venv/bin/pip" download --quiet --only-binary :all: --platform win_amd64 -d "$place/wheels" \
    panda3d==1.10.16 'numpy<2' scipy trimesh pytest colorama pip ||
    give_up "PyPI gives no $name of Windows"
  python3 -m zipfile -e "$place"/wheels/panda3d-*.whl "$place/panda3d"
  mv "$place"/panda3d/deploy_libs/{"$name.dll",*.pyd,lib*.dll,VC*.dll} "$place"
  rm -r "$place"/{panda3d,_wmi.pyd}
  tar -C "$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("stdlib"))')" \
    --exclude='./*-packages' --exclude=./test --exclude=./lib-dynload --exclude='./config-*' \
    --exclude=__pycache__ -c . | tar -C "$place/Lib" -x
  sed "s/^_*Py[^ ]*/& = $name.&/" "$tree/python/python3.def" >"$place/python3.def"
  $triplet-gcc-posix -shared "$place/python3.def" -o "$place/python3.dll"
  echo '#include <wchar.h>
    int Py_Main(int, wchar_t**);
    int wmain(int count, wchar_t** words) { return Py_Main(count, words); }' |
    $triplet-gcc-posix -municode -xc - -xnone "$place/$name.dll" -o "$place/python.exe"
  windows_python "Z:$(echo "$place"/wheels/pip-*.whl)/pip" install --quiet --no-index \
    --no-warn-script-location --find-links "Z:$place/wheels" "Z:$wheel" scipy trimesh pytest

  # Left out: tests of the tree itself; concurrent.futures' pool, which waits for ever in wine; a
  # program started for each format, which takes minutes there.
  for name in $(bindings/python/tests/run.sh --short-files); do
    [[ $name = test_package.py ]] || tests+=("Z:$PWD/bindings/python/tests/$name")
  done
  PYTHONDONTWRITEBYTECODE=1 windows_python -m pytest -q -p no:cacheprovider \
    -k "not come_back_from_a_process_pool and not saved_as_the_program" "${tests[@]}" \
    >"$tree/results/package.log" || good=false
  echo "package: $(tail -n 1 "$tree/results/package.log")"
  windows_python "Z:$PWD/tests/windows/wheel_test.py" "Z:$place/files" || good=false
  [[ ! -x $program ]] ||
    python3 tests/windows/wheel_test.py "$place/files" "$(realpath "$program")" || good=false

  # On another system, and without what lies beside it: one line.
  ! "$venv/bin/pip" install --no-deps "$wheel" 2>"$place/refused" || good=false
  rm "$place/Lib/site-packages/cullhull/cullhull.dll"
  ! windows_python -c 'import cullhull' >>"$place/refused" || good=false
  grep 'is not a supported wheel' "$place/refused" && grep '^ImportError: DLL' "$place/refused" ||
    good=false
  $good
}

[[ $# -gt 0 ]] || set -- libraries build wheel test package
for tool in $triplet-g++-posix $triplet-windres wine; do
  command -v $tool >/dev/null || give_up "no $tool (scripts/install-deps.sh windows)"
done
for step in "$@"; do
  case "$step" in
    libraries | build | wheel | test | package | short) "make_$step" ;;
    *)
      sed -n '2,16s/^# \{0,1\}//p' "$0" >&2
      exit 2
      ;;
  esac
done
