#!/usr/bin/env bash
# Fetches packages by an apt of our own, which leaves the machine's as it is and checks Debian's
# signatures: scripts/apt-fetch.sh FOLDER "SOURCES LINE" APT-GET-COMMAND...
# FOLDER holds its lists; ARCHITECTURE names another than this machine's. The packages lie in the
# working directory. Exit status 77: not possible.
set -euo pipefail
state=$(realpath -m "$1")
mkdir -p "$state/lists/partial" "$state/cache/archives/partial"
echo "$2" >"$state/sources.list"
touch "$state/status"
options=(-qq -o "Dir::Etc::sourcelist=$state/sources.list" -o Dir::Etc::sourceparts=/dev/null
  -o "Dir::State::lists=$state/lists" -o "Dir::State::status=$state/status"
  -o "Dir::Cache=$state/cache" -o APT::Sandbox::User=root
  ${ARCHITECTURE:+-o "APT::Architecture=$ARCHITECTURE" -o "APT::Architectures=$ARCHITECTURE"})
apt-get "${options[@]}" update || {
  echo "apt-fetch: the mirror has not given its lists: $2" >&2
  exit 77
}
apt-get "${options[@]}" "${@:3}" || {
  echo "apt-fetch: the mirror has not given: ${*:4}" >&2
  exit 77
}
