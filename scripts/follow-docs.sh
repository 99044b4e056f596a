#!/usr/bin/env bash
# Follows the pages in an empty Debian root, word by word: README, Install and every tutorial, or what
# is named: scripts/follow-docs.sh [PAGE[#SECTION] ...]     e.g. docs/install.md#python-package
# The commands come from the Markdown (tests/docs/follow_pages.py). The repository's address is turned
# to a clone of HEAD; sudo, which a Debian has, is installed first. FOLLOW_TESTS=1 runs `make test`,
# too. Tutorials need what docs/install.md installs: its sections `python-package` and
# `from-source-with-cmake`; REUSE_ROOT=FOLDER (scripts/fresh-root.sh) goes on in a root that has them.
# Exit status 77: no root can be made here.
set -euo pipefail
cd "$(dirname "$0")/.."
pages=("$@")
[[ $# -gt 0 ]] || pages=(README.md docs/install.md docs/tutorials/*.md)
commands=$(python3 tests/docs/follow_pages.py "${pages[@]}")
address=$(sed -nE 's/.*git clone (https:[^ ]+).*/\1/p' README.md | head -n 1)
exec scripts/fresh-root.sh \
  "apt-get update -qq && apt-get install -y -qq --no-install-recommends sudo >/dev/null" \
  "git config --global url./root/cullhull.insteadOf $address" \
  "$commands"
