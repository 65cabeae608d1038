#!/bin/sh
# SPDX-License-Identifier: MIT
# test_templates.sh GICGEN: every insertion point of every template of generated files, one after another: a misspelt one
# ends gicgen with a message that names the template, the line and the right name, and so does one that is deleted.
# Mistakes are found in templates too that the model at hand does not need. Nothing is written then.
gicgen=$(realpath "$1")
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
model=$root/models/pendulum.veh
cp -r "$root/templates" "$work/templates"
cd "$work" || exit 1

# call TEMPLATE: the run of gicgen that takes this template; none for those of gicrun and gicsweep
call() {
    case $1 in
    animate* | drive* | fit* | gradient* | kc* | manoeuvre* | sheet* | study* | sweep* | jit.c.in) return 1 ;;
    batch*) set -- --batch 4 "$model" -o made.c ;;
    main.c.in) set -- --main "$model" -o made.c ;;
    fmu/*) set -- --fmu 2 "$model" -o made.fmu ;;
    report.html.in) set -- --report made.html "$model" ;;
    *) set -- "$model" -o made.c ;;
    esac
    "$gicgen" --templates templates "$@" >out 2>err
    status=$?
}

# refused TEMPLATE LINE WORDS NAME: after call()
refused() {
    [ "$status" -eq 1 ] && ! ls made.* >ls.out 2>&1 && grep -q -F -e "templates/$1:$2" err && grep -q -F -e "$3" err
    verdict $? "$4: exit status $status: $(head -n 3 err)"
    rm -f made.*
}

# points FILE: line and name of each
points() {
    sed -n -e '/^ *\/\* @.*@ \*\/$/{=;s/.*@\(.*\)@.*/\1/p;}' -e '/^ *<!-- @.*@ -->$/{=;s/.*@\(.*\)@.*/\1/p;}' "$1" |
        paste - - | tr '\t' ' '
}

for template in "$root"/templates/*.in "$root"/templates/fmu/*.in; do
    file=${template#"$root"/templates/}
    call "$file" || continue
    rm -f made.*
    points "$template" >list
    while read -r line name; do
        # another letter in front: no point has that name
        sed "${line}s/@\(.*\)@/@q\1@/" "$template" >"templates/$file"
        call "$file"
        refused "$file" "$line:" "unknown insertion point '@q$name@'" "a misspelt point: $file:$line"
        [ "${#name}" -lt 3 ] || grep -q -F -e "did you mean '@" err
        verdict $? "no name is suggested for '@q$name@': $(cat err)"
        # where no other line has the name, none gets its text
        if [ "$(cat "$root"/templates/*.in "$root"/templates/fmu/*.in | grep -c -F "@$name@")" -eq 1 ]; then
            sed "${line}d" "$template" >"templates/$file"
            call "$file"
            [ "$status" -eq 1 ] && grep -q -F -e "no template has the insertion point '@$name@'" err
            verdict $? "a deleted point: $file:$line: exit status $status: $(head -n 3 err)"
            rm -f made.*
        fi
        cp "$template" "templates/$file"
    done <list
done

# two letters that changed places; a point of another template; a name that resembles none
sed 's/@dynamics@/@dynamcis@/' "$root/templates/model.c.in" >templates/model.c.in
call model.c.in
refused model.c.in "$(grep -n '@dynamcis@' templates/model.c.in | cut -d: -f1):" "did you mean '@dynamics@'?" dynamcis
cp "$root/templates/model.c.in" templates
echo '/* @chord@ */' >>templates/model.c.in
call model.c.in
refused model.c.in "$(wc -l <templates/model.c.in):5" "unknown insertion point '@chord@'" "a point of another template"
cp "$root/templates/model.c.in" templates
echo '<!-- @xyzxyzxyz@ -->' >>templates/report.html.in
call report.html.in
refused report.html.in "$(wc -l <templates/report.html.in):" "the names known here are 'identity'" "no point"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
