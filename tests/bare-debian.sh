#!/bin/sh
# SPDX-License-Identifier: MIT
# bare-debian.sh [RELEASE [MIRROR]]: tries README's two commands where nothing is installed: on a copy of the committed and
# uncommitted files in a minimal Debian made with debootstrap. RELEASE: 12 (or bookworm, as it is by default), 13
# (trixie) or another name; MIRROR: otherwise the one that this Debian's packages come from. Needs root, debootstrap and
# git; takes an hour.
[ $# -le 2 ] || { echo "usage: bare-debian.sh [RELEASE [MIRROR]]" >&2; exit 2; }
case ${1:-12} in
12) release=bookworm ;;
13) release=trixie ;;
*) release=$1 ;;
esac
# shellcheck disable=SC2016  # apt's own variable
mirror=${2:-$(apt-get indextargets --format '$(REPO_URI)' 'Origin: Debian' 'Label: Debian' | head -n 1)}
[ -n "$mirror" ] || { echo "bare-debian.sh: no mirror is known here: give one" >&2; exit 2; }
cd "$(dirname "$0")/.." || exit 1
root=$(mktemp -d) || exit 1
trap 'umount "$root/proc" 2>/dev/null; rm -rf --one-file-system "$root"' EXIT
set -e
debootstrap --variant=minbase "$release" "$root" "$mirror"
cp /etc/resolv.conf "$root/etc/"
mount -t proc proc "$root/proc"
mkdir "$root/root/gicgen"
git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -C "$root/root/gicgen"
for command in demo run; do
    for how in --dry-run ''; do
        echo "==== sh tests/$command.sh $how"
        # shellcheck disable=SC2086  # a word or none
        chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin \
            sh "/root/gicgen/tests/$command.sh" $how
    done
done
