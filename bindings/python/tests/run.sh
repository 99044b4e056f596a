#!/usr/bin/env bash
# Installs the package into FOLDER/venv and runs its tests there: run.sh FOLDER [PYTEST ARGUMENTS...]
set -euo pipefail
folder=$(realpath -m "${1:?usage: run.sh FOLDER [PYTEST ARGUMENTS...]}")
shift
here=$(cd "$(dirname "$0")" && pwd)
"$here/../../../scripts/python-venv.sh" "$folder" test

# Other projects' own tests are in their source archives alone.
fetch() { # PROJECT VERSION: prints the folder of its tests
  local archive=$folder/$1-$2
  if [[ ! -d $archive ]]; then
    mkdir -p "$folder/download"
    "$folder/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps \
      --no-binary "$1" --dest "$folder/download" "$1==$2" >&2 &&
      tar -xzf "$folder/download/$1-$2.tar.gz" -C "$folder" || true
  fi
  if [[ -d $archive/tests ]]; then
    echo "$archive/tests"
  else
    echo "run.sh: $1's source archive is out of reach; its own tests are left out" >&2
  fi
}
trimesh=$("$folder/venv/bin/python" -c 'import trimesh; print(trimesh.__version__)')
CULLHULL_TRIMESH_TESTS=$(fetch trimesh "$trimesh")
export CULLHULL_TRIMESH_TESTS
# Not among the package's own needs: without it, its tests are left out.
coxeter=0.11.0
if "$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
  "coxeter==$coxeter" hypothesis miniball rtree; then
  CULLHULL_COXETER_TESTS=$(fetch coxeter "$coxeter")
  export CULLHULL_COXETER_TESTS
fi
cd "$folder" # where nothing but the installed package is called cullhull
exec "$folder/venv/bin/python" -m pytest -q -p no:cacheprovider "$@" "$here"
