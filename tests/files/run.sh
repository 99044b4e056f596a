#!/usr/bin/env bash
# Files that other people's programs write, read by ours: run.sh FOLDER PROGRAM [MPI_PROGRAM
# LAUNCHER...]. FOLDER keeps the virtual environment. Exit status 77: PyPI is out of reach.
set -euo pipefail
folder=$(realpath -m "${1:?usage: run.sh FOLDER PROGRAM}")
program=$(realpath "${2:?usage: run.sh FOLDER PROGRAM}")
here=$(cd "$(dirname "$0")" && pwd)
python=$folder/venv/bin/python
packages=(numpy scipy shapely h5py laspy lazrs pypcd4 netCDF4)
if ! "$python" -c 'import numpy, scipy, shapely, h5py, laspy, lazrs, pypcd4, netCDF4' 2>/dev/null; then
  python3 -m venv "$folder/venv" >/dev/null 2>&1 &&
    "$folder/venv/bin/pip" install --quiet --disable-pip-version-check --prefer-binary \
      "${packages[@]}" || {
    echo "files: PyPI has not given ${packages[*]}" >&2
    exit 77
  }
fi
"$python" "$here/scans.py" "$program"
exec "$python" "$here/foreign_files.py" "$program" "${@:3}"
