#!/usr/bin/env bash
# Whether library, readers, writers and program compile for Windows: every source through MinGW-w64's
# compiler (Debian: g++-mingw-w64-x86-64-posix), checked but not linked, against this machine's
# headers of the libraries. Nothing is run. Usage: scripts/mingw-check.sh [SOURCE ...]
# Exit status 77: no such compiler. JOBS: how many at once.
set -euo pipefail
cd "$(dirname "$0")/.."
compiler=x86_64-w64-mingw32-g++-posix
command -v "$compiler" >/dev/null || {
  echo "mingw-check: no $compiler (Debian: g++-mingw-w64-x86-64-posix)" >&2
  exit 77
}
folder=$PWD/build/mingw
rm -rf "$folder" && mkdir -p "$folder/include"
for path in /usr/include/{hwy,fmt,CLI,nlohmann,fast_float,gmpxx.h} \
  /usr/include/x86_64-linux-gnu/gmp.h; do
  [[ ! -e $path ]] || cp -rL "$path" "$folder/include/"
done
sources=("$@")
if [[ ${#sources[@]} -eq 0 ]]; then
  mapfile -t sources < <(find src apps/cullhull bench/suites/numbers.cpp -name '*.cpp' \
    -not -path 'src/cuda/*' -not -path 'src/shared/*' -not -name 'bench_*' | sort)
  sources+=(src/cuda/not_compiled.cpp)
fi
printf '%s\n' "${sources[@]}" | xargs -P "${JOBS:-$(nproc)}" -I{} bash -c '
  "$1" -std=c++20 -fsyntax-only -ffp-contract=off -Wall -Wextra -Wpedantic -Wshadow -Werror \
    -Wno-error=unknown-pragmas -Iinclude -Isrc -I. -Ibench/suites -isystem "$3/include" "$2" \
    >"$3/$(echo "$2" | tr / _).log" 2>&1 && echo "ok    $2" || {
    echo "WRONG $2"
    grep -m 3 -E "error" "$3/$(echo "$2" | tr / _).log"
  }' _ "$compiler" {} "$folder" | tee "$folder/all.txt"
echo "mingw-check: $(grep -c '^ok' "$folder/all.txt") sources compile, $(grep -c '^WRONG' "$folder/all.txt" || true) do not"
! grep -q '^WRONG' "$folder/all.txt"
