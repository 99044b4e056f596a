#!/usr/bin/env bash
# Builds the documentation's site: scripts/docs-site.sh FOLDER PROGRAM. FOLDER/html is the site, PROGRAM
# the built cullhull whose help becomes pages. Any warning is an error, and so is a broken local link.
# CULLHULL_VENV: a virtual environment to use in the place of FOLDER/venv.
# CULLHULL_MODULE: the folder of scripts/wasm.sh's program, which the page "Try it" runs;
# without it that page says that it is missing.
# Exit status 77: this machine cannot do it (no Doxygen, or no packages from PyPI).
set -euo pipefail
folder=$(realpath -m "${1:?usage: scripts/docs-site.sh FOLDER PROGRAM}")
program=$(realpath "${2:?usage: scripts/docs-site.sh FOLDER PROGRAM}")
cd "$(dirname "$0")/.."

if ! command -v doxygen >/dev/null; then
  echo "docs-site: there is no doxygen (scripts/install-deps.sh docs)" >&2
  exit 77
fi
scripts/docs-venv.sh "$folder"
python=${CULLHULL_VENV:-$folder/venv}/bin/python
mkdir -p "$folder/doxygen"
{ cat docs/Doxyfile; echo "OUTPUT_DIRECTORY = $folder/doxygen"; } | doxygen -
"$python" scripts/docs_source.py "$program" "$folder/doxygen/xml" "$folder/source"
"$python" -m sphinx -q -W --keep-going -b html -c docs \
  -d "$folder/doctrees" -D "breathe_projects.cullhull=$folder/doxygen/xml" "$folder/source" "$folder/html"
if [[ -n ${CULLHULL_MODULE:-} ]]; then
  cp "$CULLHULL_MODULE"/cullhull.{js,wasm} "$folder/html/_static/"
fi
"$python" scripts/check_links.py "$folder/html"
