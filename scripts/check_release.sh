#!/usr/bin/env bash
# Runs both commands of the README, quickstart.sh and test.sh, on a bare system of a Debian release: a
# clone of the last commit in a folder of its own, with nothing installed but what they install.
#
# usage: scripts/check_release.sh RELEASE [FOLDER]
#   RELEASE   bookworm or trixie
#   FOLDER    where the system goes, and stays; without it a temporary one, removed at the end
#
# Needs root, debootstrap and a network. Takes half an hour on two cores. Ends with 77 without root or
# debootstrap.

set -euo pipefail
cd "$(dirname "$0")/.."

usage() { sed -n '2,/^$/s/^# \{0,1\}//p' "$0"; }
case ${1:-} in
    -h | --help) usage; exit ;;
    bookworm | trixie) release=$1 ;;
    *) usage >&2; exit 2 ;;
esac
if [[ $EUID -ne 0 ]] || ! command -v debootstrap >/dev/null; then
    echo "check_release.sh: needs root and debootstrap; nothing was checked" >&2
    exit 77
fi

root=${2:-$(mktemp -d)}
mounts=(proc dev)
leave() {
    for mount in "${mounts[@]}"; do
        ! mountpoint -q "$root/$mount" || umount -l "$root/$mount"
    done
    [[ -n ${2:-} ]] || rm -rf --one-file-system "$root"
}
trap 'leave "$@"' EXIT

[[ -e $root/usr/bin/apt-get ]] || debootstrap --variant=minbase "$release" "$root"
chmod 755 "$root"  # tests run as another user in it
for mount in "${mounts[@]}"; do
    mountpoint -q "$root/$mount" || mount --bind "/$mount" "$root/$mount"
done
cp /etc/resolv.conf "$root/etc/resolv.conf"
rm -rf "$root/implicit-geodesic"
git clone -q . "$root/implicit-geodesic"
inside() { chroot "$root" env LC_ALL=C HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"; }
inside sh -c 'cd /implicit-geodesic && bash scripts/quickstart.sh'
inside sh -c 'cd /implicit-geodesic && bash scripts/test.sh'
echo "check_release.sh: both commands pass on $release"
