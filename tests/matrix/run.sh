#!/usr/bin/env bash
# The matrix of tests/matrix/matrix.py: run.sh FOLDER PROGRAM [--only CELL] [--large]. FOLDER holds the
# virtual environment with the package, which bindings/python/tests/run.sh makes. Exit status 77: PyPI
# is out of reach, or this machine cannot make a virtual environment.
set -euo pipefail
folder=$(realpath -m "${1:?usage: run.sh FOLDER PROGRAM}")
program=$(realpath "${2:?usage: run.sh FOLDER PROGRAM}")
here=$(cd "$(dirname "$0")" && pwd)
python=$folder/venv/bin/python
if ! "$python" -c 'import cullhull, scipy, matplotlib' 2>/dev/null || [[ ! -e $folder/extras ]]; then
  "$here/../../bindings/python/tests/run.sh" "$folder" --install
  "$here/../../bindings/python/tests/run.sh" "$folder" --extras
fi
cd "$folder" # where nothing but the installed package is called cullhull
PYTHONDONTWRITEBYTECODE=1 exec "$python" "$here/matrix.py" "$program" "$here/../.." "$folder" "${@:3}"
