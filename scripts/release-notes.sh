#!/usr/bin/env bash
# Prints the section of CHANGELOG.md about a version: scripts/release-notes.sh VERSION
set -euo pipefail
cd "$(dirname "$0")/.."
version=${1:?usage: scripts/release-notes.sh VERSION}
notes=$(awk -v head="## [$version]" '
  index($0, head) == 1 { inside = 1; next }
  /^## / { inside = 0 }
  inside' CHANGELOG.md)
if [[ -z ${notes//[[:space:]]/} ]]; then
  echo "release-notes: CHANGELOG.md says nothing of $version" >&2
  exit 1
fi
printf '%s\n' "$notes" | sed '/./,$!d'
