#!/usr/bin/env bash
# R's own check of the package, with its tests; more than notes fail:
#   tests/r/check_package.sh PACKAGE LIBRARY_FOLDER
# Exit status 77: something is missing, or not even that R says why.
set -euo pipefail
missing() { echo "check_package: $1 is not installed" && exit 77; }
command -v R >/dev/null || missing R
command -v pkg-config >/dev/null || missing pkg-config
Rscript -e 'quit(status = !requireNamespace("testthat", quietly = TRUE))' || missing testthat
package=$(realpath "$1")
export PKG_CONFIG_PATH=$2 LD_LIBRARY_PATH=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch"
R CMD build "$package"
R CMD check --no-manual cullhull_*.tar.gz
if ! grep -Eq '^Status: (OK|[0-9]+ NOTEs?)$' cullhull.Rcheck/00check.log; then
  cat cullhull.Rcheck/tests/*.Rout.fail cullhull.Rcheck/00install.out 2>/dev/null
  exit 1
fi
