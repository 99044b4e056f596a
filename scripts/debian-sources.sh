#!/usr/bin/env bash
# Unpacks Debian's sources into folders of the working directory: scripts/debian-sources.sh NAME...
# From SUITE, this Debian's release by default, of CULLHULL_MIRROR. Exit status 77: not possible here.
set -euo pipefail
shopt -s extglob
mirror=${CULLHULL_MIRROR:-http://deb.debian.org/debian}
suite=${SUITE:-$(. /etc/os-release && echo "$VERSION_CODENAME")}
"$(dirname "$0")/apt-fetch.sh" apt \
  "deb-src [signed-by=/usr/share/keyrings/debian-archive-keyring.gpg] $mirror $suite main" \
  source --download-only "$@" || exit $?
for name in "$@"; do
  mkdir "$name" && tar xf "$name"_*.orig.tar.?z?(2) -C "$name" --strip-components=1
done
# Debian leaves out GMP's manual, which its makefiles name.
if [[ -d gmp ]]; then mkdir -p gmp/doc && touch gmp/doc/Makefile.in; fi
