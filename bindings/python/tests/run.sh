#!/usr/bin/env bash
# Installs the package into FOLDER/venv and runs its tests there: run.sh FOLDER [PYTEST ARGUMENTS...]
set -euo pipefail
folder=$(realpath -m "${1:?usage: run.sh FOLDER [PYTEST ARGUMENTS...]}")
shift
here=$(cd "$(dirname "$0")" && pwd)
"$here/../../../scripts/python-venv.sh" "$folder" test

# trimesh's own tests are in its source archive alone.
version=$("$folder/venv/bin/python" -c 'import trimesh; print(trimesh.__version__)')
archive=$folder/trimesh-$version
if [[ ! -d $archive ]]; then
  mkdir -p "$folder/download"
  if "$folder/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps \
    --no-binary trimesh --dest "$folder/download" "trimesh==$version"; then
    tar -xzf "$folder/download/trimesh-$version.tar.gz" -C "$folder"
  else
    echo "run.sh: trimesh's source archive is out of reach; its own tests are left out" >&2
  fi
fi
if [[ -f $archive/tests/test_convex.py ]]; then
  export CULLHULL_TRIMESH_TESTS=$archive/tests
fi
cd "$folder" # where nothing but the installed package is called cullhull
exec "$folder/venv/bin/python" -m pytest -q -p no:cacheprovider "$@" "$here"
