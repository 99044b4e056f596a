#!/usr/bin/env bash
# Builds the Python package and installs it into FOLDER/venv: scripts/python-venv.sh FOLDER [EXTRA...]
# EXTRA: parts of the package's optional dependencies (test, plot, progress). PYTHON names another
# interpreter, CXX another compiler, CULLHULL_INSTALLED the prefix of an installed cullhull to link
# instead of compiling the library once more. Exit status 77: this machine cannot do it (no venv, or
# PyPI out of reach); anything else but 0: the build failed.
set -euo pipefail
folder=$(realpath -m "${1:?usage: scripts/python-venv.sh FOLDER [EXTRA...]}")
shift
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}

give_up() {
  echo "python-venv: $*" >&2
  exit 77
}

command -v "$python" >/dev/null || give_up "there is no $python"
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 9))' ||
  give_up "$("$python" --version) is too old; 3.9 is needed (PYTHON=... chooses another)"
if [[ ! -x $folder/venv/bin/pip ]]; then
  "$python" -m venv "$folder/venv" >/dev/null ||
    give_up "$python cannot make a virtual environment (Debian: apt-get install python3-venv)"
fi

# What the package needs, kept from one call to the next; said apart from it, so that a failure to
# reach PyPI is no failure of the build.
mapfile -t needs < <("$folder/venv/bin/python" - "$@" <<'PY'
import re, sys
text = open("pyproject.toml").read()
def strings(name):
    return re.findall(r'"([^"]+)"', re.search(rf"^{name} = \[(.*?)\]$", text, re.M | re.S)[1])
for name in ("requires", "dependencies", *sys.argv[1:]):
    print(*strings(name), sep="\n")
PY
)
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check "${needs[@]}" ||
  give_up "PyPI has not given ${needs[*]}"

settings=()
define() { settings+=(--config-settings "cmake.define.$1=$2"); }
if [[ -n ${CXX:-} ]]; then
  define CMAKE_CXX_COMPILER "$CXX"
  # Where the last build (build-dir in pyproject.toml) had another compiler, CMake would begin anew and
  # forget all the other definitions.
  for cache in build/python-*/CMakeCache.txt; do
    grep -qs "^CMAKE_CXX_COMPILER:[A-Z]*=$CXX\$" "$cache" || rm -f "$cache"
  done
fi
define CULLHULL_INSTALLED "${CULLHULL_INSTALLED:-}"
PATH="$folder/venv/bin:$PATH" "$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  --no-build-isolation --no-deps --force-reinstall "${settings[@]}" .
