#!/bin/sh
# SPDX-License-Identifier: MIT
# parts.sh begin FILE PART...: says which parts `make bench` is about to measure, and how long each took last time.
# parts.sh run FILE PART COMMAND...: runs the command, and keeps in FILE (CSV) how long it took and how many other programs
# were running just before.
what=$1
file=$2
shift 2

# others: programs that are running at this moment, without this one
others() { awk '{ split($4, n, "/"); print n[1] - 1 }' /proc/loadavg 2>/dev/null || echo 0; }

if [ "$what" = begin ]; then
    echo "parts: $*; all of them took 16 minutes on a busy machine with QUICK=1, and take a multiple of that without" >&2
    [ -s "$file" ] && for part in "$@"; do sed -n "s/^$part,\([0-9]*\),.*/$part took \1 s last time/p" "$file" >&2; done
    exit 0
fi

part=$1
shift
busy=$(others)
begun=$(date +%s)
echo "$part: $*" >&2
"$@" >/dev/null || exit 1
took=$(($(date +%s) - begun))
{
    echo 'part,s,load before'
    [ -s "$file" ] && sed "1d; /^$part,/d" "$file"
    echo "$part,$took,$busy"
} >"$file.tmp" && mv "$file.tmp" "$file"
echo "$part took $took s" >&2
