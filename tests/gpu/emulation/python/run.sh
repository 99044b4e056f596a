#!/usr/bin/env bash
# The Python package on the emulated device, in the virtual environment that the test python.install
# has made: run.sh FOLDER VENV INSTALLED EMULATED CUDA_INCLUDE. Links the extension module in FOLDER
# with the library
# EMULATED in the place of the core, and runs what the tests of the package leave out without a device.
# Exit status 77: there is no virtual environment.
set -euo pipefail
folder=$(realpath -m "$1") venv=$2 installed=$3 emulated=$4 include=$5
here=$(cd "$(dirname "$0")" && pwd)
root=$(realpath "$here/../../../..")
if ! "$venv/bin/python" -c "import nanobind, numpy, pytest" 2>/dev/null; then
  echo "emulated python: the test python.install has made no virtual environment in $venv" >&2
  exit 77
fi

# pip compiles in build-dir of pyproject.toml, whose {wheel_tag} ends with the platform.
tag=$("$venv/bin/python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
compiled=("$root/build/python-$tag-"*)
cmake -S "$here" -B "$folder" -G Ninja "-DPython_EXECUTABLE=$venv/bin/python" \
  "-DCULLHULL_INSTALLED=$installed" "-DCULLHULL_EMULATED=$emulated" \
  "-DCULLHULL_CUDA_INCLUDE=$include" "-DCULLHULL_PIP_BUILD=${compiled[0]}" >"$folder.log"
cmake --build "$folder" >>"$folder.log" || {
  cat "$folder.log" >&2
  exit 1
}
cp -r "$root"/bindings/python/cullhull/. "$folder/package/cullhull/"

tests=$root/bindings/python/tests
# No plugins: one of zarr's looks for CuPy, of which there is but a part here.
cd "$folder"
PYTEST_DISABLE_PLUGIN_AUTOLOAD=1 PYTHONPATH="$folder/package:$here" PYTHONDONTWRITEBYTECODE=1 \
  exec "$venv/bin/python" -m pytest -q -p no:cacheprovider -p emulated "$here/test_emulated.py" \
  "$tests/test_arrays.py::test_batches_and_questions_on_a_device" \
  "$tests/test_arrays.py::test_hulls_left_on_a_device" \
  "$tests/test_recipes.py" -k "not test_recipe or cupy"
