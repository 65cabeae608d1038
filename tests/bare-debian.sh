#!/bin/sh
# SPDX-License-Identifier: MIT
# bare-debian.sh MIRROR [SUITE]: tries README's two commands where nothing is installed: on a copy of the committed and
# uncommitted files in a minimal Debian made with debootstrap. Needs root, debootstrap and git; takes some minutes.
[ $# -ge 1 ] || { echo "usage: bare-debian.sh MIRROR [SUITE]" >&2; exit 2; }
cd "$(dirname "$0")/.." || exit 1
root=$(mktemp -d) || exit 1
trap 'umount "$root/proc" 2>/dev/null; rm -rf --one-file-system "$root"' EXIT
set -e
debootstrap --variant=minbase "${2:-bookworm}" "$root" "$1"
cp /etc/resolv.conf "$root/etc/"
mount -t proc proc "$root/proc"
mkdir "$root/root/gicgen"
git ls-files -z --cached --others --exclude-standard | tar -c --null -T - | tar -x -C "$root/root/gicgen"
for command in demo run; do
    echo "==== sh tests/$command.sh"
    chroot "$root" /usr/bin/env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin sh "/root/gicgen/tests/$command.sh"
done
