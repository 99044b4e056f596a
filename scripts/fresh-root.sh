#!/usr/bin/env bash
# Runs commands in a clone of HEAD on a Debian or Ubuntu machine from nothing:
#   scripts/fresh-root.sh COMMAND...       each argument is one command line, run as root by bash
# debootstrap makes the root (minbase, with make, git and ca-certificates alone) of ROOT_RELEASE
# (default: this machine's Debian; noble is Ubuntu 24.04) in a folder below CULLHULL_ROOTS (default:
# /var/tmp), which is removed at the end, unless KEEP_ROOT=1. The settings of apt and pip are copied
# from this machine; CUDA's folder is mounted where nvcc is found. Exit status 77, with one line: no
# root can be made here. Otherwise that of the first command that fails, or 0.
# After each command it says how long it took, its processor time, what this machine received over its
# network meanwhile, and what lies in the root; ROOT_REPORT=FILE gets the same as lines of numbers
# (seconds, MB, MB, seconds of processor time) and the command.
# While one works on the commands: REUSE_ROOT=FOLDER makes the root there, or goes on in the one that
# is there, with the clone at today's HEAD; ROOT_CCACHE=FOLDER is the root's compiler cache.
set -euo pipefail
cd "$(dirname "$0")/.."

give_up() {
  echo "fresh-root: $*" >&2
  exit 77
}
[[ $# -gt 0 ]] || { echo "usage: scripts/fresh-root.sh COMMAND..." >&2; exit 2; }
[[ $(id -u) -eq 0 ]] || give_up "only root can make a root"
command -v apt-get >/dev/null || give_up "there is no apt-get"
if ! command -v debootstrap >/dev/null; then
  { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends \
    debootstrap debian-archive-keyring; } >/dev/null 2>&1 || give_up "debootstrap cannot be installed"
fi
unshare --mount --pid --fork true 2>/dev/null || give_up "this system does not allow namespaces"

# shellcheck disable=SC1091
here=$(. /etc/os-release && [[ ${ID:-} = debian ]] && echo "${VERSION_CODENAME:-}" || true)
release=${ROOT_RELEASE:-${here:-bookworm}}
making=(--variant=minbase "--include=make,git,ca-certificates")
case "$release" in
  bullseye | bookworm | trixie | forky | testing | sid)
    mirror=$(sed -nE 's/^URIs: *([^ ]+).*/\1/p; s/^deb (\[[^]]*\] *)?([^ ]+).*/\2/p' \
      /etc/apt/sources.list.d/debian.sources /etc/apt/sources.list 2>/dev/null |
      grep -m 1 '/debian/\?$' || true)
    mirror=${CULLHULL_MIRROR:-${mirror:-http://deb.debian.org/debian}}
    script=sid
    sources="deb $mirror $release main" ;;
  *)  # Ubuntu, whose keys a Debian may not have
    mirror=${CULLHULL_MIRROR:-http://archive.ubuntu.com/ubuntu}
    script=gutsy
    sources=$(printf 'deb %s %s main universe\n' "$mirror" "$release" "$mirror" "$release-updates")
    keys=/usr/share/keyrings/ubuntu-archive-keyring.gpg
    if [[ -e $keys ]]; then making+=("--keyring=$keys"); else making+=(--no-check-gpg); fi ;;
esac
if [[ -e /usr/share/debootstrap/scripts/$release ]]; then script=$release; fi

if [[ -n ${REUSE_ROOT:-} ]]; then
  KEEP_ROOT=1
  mkdir -p "$REUSE_ROOT"
  root=$(realpath "$REUSE_ROOT")
else
  mkdir -p "${CULLHULL_ROOTS:-/var/tmp}"
  root=$(mktemp -d "${CULLHULL_ROOTS:-/var/tmp}/cullhull-root.XXXXXX")
fi
clean_up() { [[ ${KEEP_ROOT:-} = 1 ]] || rm -rf "$root"; }
trap clean_up EXIT
echo "fresh-root: $release from $mirror, in $root"
if [[ ! -e $root.complete ]]; then
  if ! debootstrap "${making[@]}" "$release" "$root" "$mirror" \
    "/usr/share/debootstrap/scripts/$script" >"$root.log" 2>&1; then
    tail -n 3 "$root.log" >&2
    rm -f "$root.log"
    give_up "debootstrap failed"
  fi
  rm -f "$root.log"
  [[ -z ${REUSE_ROOT:-} ]] || touch "$root.complete"
fi

# What this machine needs to reach the archives: sources of Debian alone, settings, certificates.
rm -f "$root/etc/apt/sources.list"
mkdir -p "$root/etc/apt/sources.list.d" "$root/etc/apt/apt.conf.d"
if [[ $release = "$here" && -e /etc/apt/sources.list.d/debian.sources ]]; then
  cp /etc/apt/sources.list.d/debian.sources "$root/etc/apt/sources.list.d/"
else
  echo "$sources" >"$root/etc/apt/sources.list"
fi
for setting in /etc/apt/apt.conf.d/*; do  # not the hooks of other programs
  grep -q '^ *Acquire' "$setting" && ! grep -q 'Invoke' "$setting" &&
    cp "$setting" "$root/etc/apt/apt.conf.d/"
done
cp -L /etc/resolv.conf /etc/hosts "$root/etc/"
cp -L /etc/ssl/certs/ca-certificates.crt "$root/etc/ssl/certs/ca-certificates.crt"
if compgen -G '/usr/local/share/ca-certificates/*.crt' >/dev/null; then
  cp /usr/local/share/ca-certificates/*.crt "$root/usr/local/share/ca-certificates/"
fi
[[ ! -e /etc/pip.conf ]] || cp /etc/pip.conf "$root/etc/pip.conf"
mkdir -p "$root/root/.config/pip"
for settings in ~/.config/pip/pip.conf ~/.pip/pip.conf; do
  [[ ! -e $settings ]] || cp "$settings" "$root/root/.config/pip/pip.conf"
done
variables=(HOME=/root LANG=C.UTF-8 TERM=dumb)
while IFS= read -r name; do
  variables+=("$name=${!name}")
done < <(compgen -e | grep -E '^(CI|JOBS|CMAKE_BUILD_PARALLEL_LEVEL|PIP_.*|.*_proxy|.*_PROXY|SSL_CERT_FILE|REQUESTS_CA_BUNDLE)$' || true)

mounts=()
path=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin
if nvcc=$(command -v nvcc); then
  cuda=$(dirname "$(dirname "$(realpath "$nvcc")")")
  if [[ -x $cuda/bin/nvcc && $cuda != /usr ]]; then
    mounts+=("$cuda")
    path=$cuda/bin:$path
  fi
fi
if [[ -d ${PIP_FIND_LINKS:-} ]]; then mounts+=("$PIP_FIND_LINKS"); fi

if [[ -n ${ROOT_CCACHE:-} ]]; then
  mkdir -p "$root/root/.cache/ccache"
  variables+=(CCACHE_DIR=/root/.cache/ccache CCACHE_BASEDIR=/root CCACHE_NOHASHDIR=1)
fi

if [[ -e $root/root/cullhull ]]; then
  git -C "$root/root/cullhull" fetch --quiet "$PWD" HEAD
else
  git clone --quiet --no-hardlinks . "$root/root/cullhull"
fi
git -C "$root/root/cullhull" checkout --quiet --detach "$(git rev-parse HEAD)"

# inside COMMAND: the root's own /proc, /dev and /sys; gone with the processes when it ends.
inside() {
  unshare --mount --pid --fork --kill-child bash -euc '
    root=$1 command=$2 path=$3 cache=$4
    shift 4
    mount -t proc proc "$root/proc"
    mount --rbind /sys "$root/sys"
    mount --rbind /dev "$root/dev"
    while [[ $1 != -- ]]; do
      mkdir -p "$root$1"
      mount --bind "$1" "$root$1"
      mount -o remount,bind,ro "$root$1"
      shift
    done
    shift
    [[ -z $cache ]] || mount --bind "$cache" "$root/root/.cache/ccache"
    exec chroot "$root" /usr/bin/env -i "PATH=$path" "$@" \
      bash -c "cd /root/cullhull && $command"' fresh-root "$root" "$1" "$path" \
    "${ROOT_CCACHE:-}" "${mounts[@]}" -- "${variables[@]}" </dev/null
}
received() {
  awk -F '[: ]+' '{sub(/^ +/, "")} $1 != "lo" && $2 ~ /^[0-9]+$/ {sum += $2}
    END {printf "%.0f", sum / 1e6}' /proc/net/dev
}
processor_time() { awk '{printf "%.0f", ($16 + $17) / 100}' "/proc/$$/stat"; } # of all that has ended
on_disk() { du -sx --block-size=1000000 "$root" 2>/dev/null | cut -f 1; }
for command in "$@"; do
  echo "fresh-root: $command"
  before=$SECONDS received_before=$(received) processor_before=$(processor_time)
  inside "$command"
  figures=$((SECONDS - before))$'\t'$(($(received) - received_before))$'\t'$(on_disk)
  figures+=$'\t'$(($(processor_time) - processor_before))
  IFS=$'\t' read -r seconds fetched size processor <<<"$figures"
  echo "fresh-root: $command: $((seconds / 60)):$(printf '%02d' $((seconds % 60)))," \
    "$processor s of processor time, $fetched MB received, $size MB on disk"
  [[ -z ${ROOT_REPORT:-} ]] || printf '%s\t%s\n' "$figures" "$command" >>"$ROOT_REPORT"
done
