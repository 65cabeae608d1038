#!/bin/sh
# SPDX-License-Identifier: MIT
# layers.sh ROOT OBJECTS: prints a line for each include and each call, or use of data, from a folder of ROOT/generator or
# ROOT/runtime to one that stands below it in tests/layers.txt, for each include of a private header of another folder, and
# for each folder that only the list or only the disk has, and for what a folder with a star uses beside the library's
# interface. OBJECTS: the build folder, with an object of each source.
root=$1
objects=$2
table=$(dirname "$0")/../layers.txt
cd "$root" || exit 1

find generator runtime -name '*.[ch]' | sort >"$objects/layers.files"

# rank[folder] and what awk shares; `up` is true where a file of folder a may not use folder b
# shellcheck disable=SC2016  # of awk
ranks='
    function folder(path) { sub(/\/[^\/]*$/, "", path); return path }
    function thin(own, to) { return star[own] && to != own && to !~ /^(runtime|generator\/base|runtime\/host)$/ }
    FILENAME == table { if ($0 !~ /^#/ && NF) { rank[$1] = ++count; star[$1] = $2 == "*" } next }'

awk -v table="$table" "$ranks"'
    { seen[folder($0)] = 1 }
    END {
        for (f in seen) if (!(f in rank)) print f "/: no line in tests/layers.txt"
        for (f in rank) if (!(f in seen)) print f "/: in tests/layers.txt, but without a file"
    }' "$table" "$objects/layers.files"

# included as "folder/name.h" from generator/ or runtime/, as "name.h" of the runtime core, or "name.c" of the own folder, or "templates/name.c"
# shellcheck disable=SC2046  # one argument a path
awk -v table="$table" "$ranks"'
    FILENAME == files { file[$0] = 1; next }
    /^#include "/ {
        name = $2
        gsub(/"/, "", name)
        own = folder(FILENAME)
        if (name ~ /^(\.\.\/\.\.\/)?templates\// || (own "/" name) in file) next
        to = ("generator/" name) in file ? "generator/" name : "runtime/" name
        if (!(to in file))
            print FILENAME ":" FNR ": includes " name ", which is no file of ours; write folder/name.h"
        else if (rank[folder(to)] > rank[own])
            print FILENAME ":" FNR ": includes " name ", of a folder that stands on this one"
        else if (thin(own, folder(to)))
            print FILENAME ":" FNR ": includes " name ", in a command line over the library"
        else if (to ~ /_private\.h$/ && folder(to) != own)
            print FILENAME ":" FNR ": includes " name ", which is private to its folder"
    }' files="$objects/layers.files" "$table" "$objects/layers.files" $(cat "$objects/layers.files")

# nm -A -g: "path.o: value kind name", "path.o: U name"
grep '\.c$' "$objects/layers.files" | sed 's/c$/o/' | (cd "$objects" && xargs nm -A -g) >"$objects/layers.symbols" || echo "nm failed"
awk -v table="$table" "$ranks"'
    { path = $1; sub(/:.*/, "", path); name = $NF; kind = $(NF - 1) }
    kind ~ /[TDBRCVW]/ && !(name in home) { home[name] = path }
    kind == "U" { use[++uses] = path; used[uses] = name }
    END {
        if (!uses) print "no object has a symbol"
        for (i = 1; i <= uses; ++i) {
            to = home[used[i]]
            if (to == "") continue
            over = thin(folder(use[i]), folder(to)) && used[i] !~ /^gicl_/
            if (!over && rank[folder(to)] <= rank[folder(use[i])]) continue
            sub(/o$/, "c", to)
            sub(/o$/, "c", use[i])
            print use[i] ": uses " used[i] " of " to (over ? ", in a command line over the library" : ", a folder that stands on this one")
        }
    }' "$table" "$objects/layers.symbols"
rm -f "$objects/layers.files" "$objects/layers.symbols"
