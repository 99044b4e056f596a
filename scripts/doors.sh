#!/usr/bin/env bash
# Installs the C library in an empty Debian root and calls it there from every language that Debian
# has: the samples of docs/how-to/languages.md, which must print what that page says, R's own check
# of bindings/r, and the npm package's tests in Debian's node:
#   scripts/doors.sh
# Variables are those of scripts/fresh-root.sh. Exit status 77: no root can be made here.
set -euo pipefail
cd "$(dirname "$0")/.."
languages="rustc golang-go mono-mcs mono-runtime octave octave-dev"
languages+=" r-base-dev r-cran-testthat"
parts="-DCULLHULL_BUILD_APPS=OFF -DCULLHULL_BUILD_IO=OFF"
exec scripts/fresh-root.sh \
  "apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq \
    --no-install-recommends python3 $languages >/dev/null" \
  "scripts/install-deps.sh wasm" \
  "cmake --preset install $parts" \
  "cmake --build --preset install && cmake --install build/install --prefix /usr && ldconfig" \
  "python3 tests/docs/language_samples.py /usr/include /usr/lib --all" \
  "tests/r/check_package.sh bindings/r /usr/lib" \
  "for m in plane space; do g++ -std=c++20 -O2 -I. -DCULLHULL_JS_\${m^^} tests/js/native.cpp \
    -lcullhull -lgmp -o build/js_native_\$m; done && tests/js/run.sh build"
