#!/usr/bin/env bash
# Compares the binary interface of libcullhull.so with the stored one (libabigail): every exported
# function with its types, every public struct with the offsets of its members.
#   scripts/abi.sh --check [LIBRARY]    status 1 and a report where they differ
#   scripts/abi.sh --store [LIBRARY]    store it; docs/building.md says when
# LIBRARY has debug information, or is a dump that abidw wrote; without it the preset `abi` is built.
# Exit status 77: no libabigail (Debian: abigail-tools), or nothing is stored for this processor.
set -euo pipefail
folder=$(cd "$(dirname "$0")/.." && pwd)
what=${1-} library=${2-}
[[ $what == --check || $what == --store ]] && [[ $# -le 2 ]] || {
  echo "usage: scripts/abi.sh --check|--store [LIBRARY]" >&2
  exit 2
}
stored=$folder/packaging/abi/libcullhull-$(uname -m).abi.xz
command -v abidw >/dev/null && command -v abidiff >/dev/null || {
  echo "abi: no libabigail (Debian: abigail-tools)" >&2
  exit 77
}
[[ $what == --store || -e $stored ]] || {
  echo "abi: no ${stored#"$folder/"}; scripts/abi.sh --store writes it" >&2
  exit 77
}
if [[ -z $library ]]; then
  (cd "$folder" && cmake --preset abi && cmake --build --preset abi) >&2
  library=$folder/build/abi/src/shared/libcullhull.so
fi

scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
now=$scratch/now.abi
if [[ $library == *.abi ]]; then
  cp "$library" "$now"
else
  abidw --suppressions "$folder/packaging/abi/libcullhull.suppr" \
    --headers-dir "$folder/include/cullhull" --drop-private-types --drop-undefined-syms \
    --exported-interfaces-only --no-show-locs --no-corpus-path --no-comp-dir-path \
    --no-elf-needed --no-parameter-names --no-write-default-sizes "$library" >"$now"
fi
grep -q "<class-decl name='Options'" "$now" || {
  echo "abi: $library has no debug information" >&2
  exit 2
}
if [[ $what == --store ]]; then
  mkdir -p "${stored%/*}"
  xz -9e -c "$now" >"$stored"
  echo "abi: written: ${stored#"$folder/"}"
  exit 0
fi

# Bits of the status: 1 and 2 an error, 4 a change, 8 one that surely breaks programs.
xz -dc "$stored" >"$scratch/stored.abi"
status=0
abidiff --no-corpus-path "$scratch/stored.abi" "$now" >"$scratch/report" || status=$?
if [[ $status -eq 0 ]]; then
  echo "abi: the interface is the stored one"
  exit 0
fi
cat "$scratch/report"
if ((status & 3)); then
  echo "abi: abidiff failed" >&2
  exit 2
fi
echo "abi: the interface has changed; docs/building.md, \"The binary interface\", says what to do" >&2
exit 1
