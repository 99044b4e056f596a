#!/usr/bin/env bash
# Makes a release of what is checked out:
#   scripts/release.sh VERSION            commit, tag, artifacts and notes
#   scripts/release.sh VERSION --dry-run  the same in a clone that is thrown away; shows commit, tag and
#                                         notes, installs and runs each artifact in empty roots, and
#                                         leaves here the artifacts, in build/release-VERSION, and
#                                         their sizes, in docs/install.md
# 1. Checks: nothing uncommitted, a version above all tags, a changelog with something unreleased.
# 2. Writes the version into every place (scripts/stamp.py), its section into CHANGELOG.md and the
#    date into CITATION.cff, commits that and tags it vVERSION.
# 3. Builds static programs, wheels, files for Windows, sources, packages, their list of contents and
#    checksums (scripts/artifacts.sh) into build/dist, where notes-VERSION.md is the text of the release.
# Pushes nothing: it prints the command. On the tag, GitHub builds all artifacts anew and publishes
# them (.github/workflows/release.yml). ARTIFACTS names what is built (none: ARTIFACTS=).
set -euo pipefail
cd "$(dirname "$0")/.."

fail() {
  echo "release: $*" >&2
  exit 1
}
usage() {
  sed -n '2,15s/^# \{0,1\}//p' "$0" >&2
  exit 2
}

version=${1:-} dry=false check=(--here)
[[ $version =~ ^[0-9]+\.[0-9]+\.[0-9]+$ ]] || usage
case "${2:-}" in
  "") ;;
  --dry-run) dry=true check=() ;;
  *) usage ;;
esac
[[ $# -le 2 ]] || usage
artifacts=${ARTIFACTS-static wheels cross windows sdist deb sbom sums}

git rev-parse --git-dir >/dev/null 2>&1 || fail "this is not a clone"
[[ -z $(git status --porcelain) ]] || fail "there are uncommitted changes"
git rev-parse -q --verify "refs/tags/v$version" >/dev/null && fail "there is a tag v$version"
newest=$(git tag --list 'v[0-9]*' --sort=-version:refname | head -n 1)
if [[ -n $newest ]]; then
  highest=$(printf '%s\n' "${newest#v}" "$version" | sort -V | tail -n 1)
  [[ $highest == "$version" ]] || fail "$version is below $newest"
fi
python3 scripts/stamp.py || fail "version and addresses do not agree"
grep -qx '## \[Unreleased\]' CHANGELOG.md || fail "CHANGELOG.md has no section [Unreleased]"
grep -q "^## \[$version\]" CHANGELOG.md && fail "CHANGELOG.md has a section $version"

if $dry; then
  scratch=$(mktemp -d) here=$PWD
  trap 'rm -rf "$scratch"' EXIT
  git clone --quiet --no-hardlinks . "$scratch/clone"
  cd "$scratch/clone"
  # What was fetched or is of others, not of the tree; and what ccache has compiled here.
  mkdir -p build
  [[ ! -e $here/build/sysroot/complete ]] || cp -r "$here/build/sysroot" build/
  for name in ${artifacts:+roots zig}; do
    mkdir -p "$here/build/$name" && ln -s "$here/build/$name" build/
  done
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1
fi

# The commit.
date=$(date -u +%Y-%m-%d)
python3 scripts/stamp.py --version "$version"
python3 - "$version" "$date" <<'PY'
import re, sys
from pathlib import Path

version, date = sys.argv[1:]
log = Path("CHANGELOG.md")
text = log.read_text(encoding="utf-8")
head = "## [Unreleased]\n"
body = text.partition(head)[2]
section = re.split(r"^## ", body, maxsplit=1, flags=re.M)[0]
if not section.strip():
    sys.exit("release: nothing stands under [Unreleased] in CHANGELOG.md")
log.write_text(text.replace(head, f"{head}\n## [{version}] - {date}\n", 1), encoding="utf-8")
citation = Path("CITATION.cff")
text = re.sub(r"^date-released: .*\n", "", citation.read_text(encoding="utf-8"), flags=re.M)
text = re.sub(r"^(version: .*\n)", rf"\g<1>date-released: {date}\n", text, flags=re.M)
citation.write_text(text, encoding="utf-8")
PY
mkdir -p build/dist
scripts/release-notes.sh "$version" >"build/dist/notes-$version.md"
git commit --quiet --all --message "Release $version"
git tag --annotate "v$version" --message "cullhull $version"
if $dry; then
  git --no-pager show --stat --format='%s%n' HEAD
  echo "tag: $(git describe --exact-match)"
  echo "notes:"
  cat "build/dist/notes-$version.md"
fi

if [[ -n $artifacts ]]; then
  SOURCE_DATE_EPOCH=$(git log -1 --format=%ct)
  export SOURCE_DATE_EPOCH
  # shellcheck disable=SC2086
  scripts/artifacts.sh $artifacts
  PROGRAM=build/portable/bin/cullhull scripts/check-artifacts.sh "${check[@]}"
fi
if $dry; then
  if [[ -n $artifacts ]]; then
    mkdir -p "$here/build/release-$version" && cp build/dist/* "$here/build/release-$version/"
    scripts/artifacts.sh sizes && cp docs/install.md "$here/docs/install.md"
  fi
  echo "release: a dry run; nothing else was changed here. Artifacts: ${artifacts:-none}"
  exit 0
fi
echo "release: committed and tagged v$version; to publish it:"
echo "  git push origin HEAD v$version"
