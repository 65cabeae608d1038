#!/bin/sh
# SPDX-License-Identifier: MIT
# test_pages.sh GICGEN GICRUN GICSWEEP GICBENCH: the commands on the pages work. Every command of every page, that is every
# line indented by four blanks, is run as it stands, page by page in a folder of its own, and must succeed. `make TARGET` is
# asked for what it would do; of `sh tests/NAME.sh`, which would run this test again, the file must exist, and of `python3
# tests/NAME.py` the options too. Every link and picture leads to a file. The model that README.md shows is the one that it
# links to. test_snippets.sh tries commands and pieces of models inside sentences.
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
for program in "$@"; do
    case $program in /*) ;; *) program=$PWD/$program ;; esac
    mkdir -p "$work/build"
    ln -s "$program" "$work/build/"
done

pages() { (cd "$root" && echo README.md generator/*.md runtime/*.md models/*.md tests/*.md tests/bench/*.md tests/random/*/*.md); }
# commands PAGE: outside of fences
commands() { sed -n '/^```/,/^```/d; s/^ \{4,\}\([a-z].*\)/\1/p' "$root/$1" | grep -E '^(build/|mkdir |sh |make |cc |gcc |clang |python3 )'; }

# execute COMMAND: in the present folder
execute() {
    case $1 in
        make\ *)
            # shellcheck disable=SC2046  # a list of words
            make --no-print-directory -s -C "$root" -n $(echo "${1#make }" | sed 's/ *#.*//; s/"\([^" ]*\) [^"]*"/\1/')
            ;;
        python3\ tests/*) # a long one: the file and its options are there
            file=$root/$(echo "${1#python3 }" | sed 's/ .*//')
            for option in $(echo "${1%%#*}" | grep -o -- '--[a-z-]*'); do grep -qF -- "\"$option\"" "$file" || return 1; done
            [ -s "$file" ]
            ;;
        sh\ tests/*)
            file=${1#sh }
            [ -s "$root/${file%% *}" ]
            ;;
        *) sh -c "$1" ;;
    esac >"$work/out" 2>"$work/err"
}

for page in $(pages); do
    folder=$work/$(echo "$page" | tr '/.' '__')
    mkdir "$folder"
    for entry in models runtime templates tests; do ln -s "$root/$entry" "$folder/"; done
    ln -s "$work/build" "$folder/build"
    # the program of README's example stands in front of the commands that compile it
    sed -n '/^```c$/,/^```$/p' "$root/$page" | sed '/^```/d' >"$folder/main.c"
    commands "$page" >"$work/commands"
    cd "$folder" || exit 1
    while read -r command; do
        execute "$command" </dev/null
        verdict $? "$page: $command"
    done <"$work/commands"
    cd "$work" || exit 1
    : >out
    : >err
    for link in $(grep -o '](\([^)#]*\))' "$root/$page" | sed 's/^](//; s/)$//' | grep -v '^http'); do
        [ -e "$(dirname "$root/$page")/$link" ]
        verdict $? "$page: link to $link"
    done
done
check 'commands were found' [ "$passed" -gt 60 ]

check 'the README is short' [ "$(wc -l <"$root/README.md")" -le 150 ]
shown() { sed -n '/^```yaml$/,/^```$/p' "$root/README.md" | sed '/^```/d'; }
shown >"$work/shown"
sed '/^#/d' "$root/models/tutorial/1_arm.veh" >"$work/linked"
check 'the model of the README is the one it links to' cmp "$work/shown" "$work/linked"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
