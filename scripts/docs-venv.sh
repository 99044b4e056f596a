#!/usr/bin/env bash
# Puts what the documentation's site is built by (docs/requirements.txt) into FOLDER/venv, or into the
# virtual environment that CULLHULL_VENV names: scripts/docs-venv.sh FOLDER. PYTHON names another
# interpreter. Exit status 77: this machine cannot do it (no venv, or PyPI out of reach).
set -euo pipefail
folder=$(realpath -m "${1:?usage: scripts/docs-venv.sh FOLDER}")
cd "$(dirname "$0")/.."
python=${PYTHON:-python3}
venv=${CULLHULL_VENV:-$folder/venv}

give_up() {
  echo "docs-venv: $*" >&2
  exit 77
}

command -v "$python" >/dev/null || give_up "there is no $python"
if [[ ! -x $venv/bin/pip ]]; then
  "$python" -m venv "$venv" >/dev/null ||
    give_up "$python cannot make a virtual environment (Debian: apt-get install python3-venv)"
fi
# Asked for again only where the list has changed.
stamp=$venv/requirements.txt
if ! cmp -s docs/requirements.txt "$stamp"; then
  "$venv/bin/pip" install --quiet --disable-pip-version-check -r docs/requirements.txt ||
    give_up "PyPI has not given the packages of docs/requirements.txt"
  cp docs/requirements.txt "$stamp"
fi
