#!/bin/sh
# SPDX-License-Identifier: MIT
# pages.sh GICGEN GICRUN GICBENCH GICSWEEP: names of files and texts of models in tables, pictures and pages
#
# They must arrive there as they are, but for blanks, and never become a command of gnuplot, of a shell or of a browser,
# another cell or another tag. Pictures are whole or refused; a folder that has a report already has nothing of it
# afterwards. In short every third of the texts and names.
gicgen=$(realpath "$1")
gicrun=$(realpath "$2")
gicbench=$(realpath "$3")
gicsweep=$(realpath "$4")
here=$(realpath "$(dirname "$0")")
models=$(realpath "$here/../../models")
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
GICGEN_CACHE=
export GICGEN_CACHE
found=0
[ "$STRESS" = short ] && every=3 || every=1

begin() { tried=0 good=0 refused=0 wrong=; }
# count REASON LABEL: what is wrong, or nothing
count() {
    reason=$1
    if [ -n "$(find . -name 'spoilt*')" ]; then
        find . -name 'spoilt*' -delete
        reason="became a command"
    fi
    tried=$((tried + 1))
    if [ -n "$reason" ]; then
        wrong=${wrong:-$(printf '%s: %s' "$2" "$reason" | tr '\n|' ' /')}
        found=1
        printf '%s: %s\n' "$2" "$reason" >&2
    elif [ "$status" -eq 0 ]; then
        good=$((good + 1))
    else
        refused=$((refused + 1))
    fi
}
row() { echo "pages | $1 | $tried | $good | $refused | | ${wrong:-ok}"; }

# names.json, texts.json; text_N.veh, a model whose input, parameter and description have text number N
python3 "$here/pages.py" write >counts || exit 1
read -r names texts <counts
look() { python3 "$here/pages.py" "$@" 2>&1; }
# whatever stands behind the last character keeps an end of a line at the end
take_name() {
    name=$(python3 "$here/pages.py" name "$1")
    name=${name%x}
}

cat >car.scene <<END
gicscene: 1
duration: 0.05
step: 0.005
integrator: rk4
outputs: [tip, input.u]
plot: [input.u, tip.x, {x: input.u, y: tip.x}]
END

# ---- texts of a model ----
"$gicrun" -q --engine tape text_0.veh car.scene --animate harmless_run.html && "$gicgen" --report harmless.html text_0.veh ||
    exit 1
begin
i=0
while [ $i -lt "$texts" ]; do
    rm -f out.* page.html run.html
    "$gicrun" -q --engine tape text_$i.veh car.scene -o out.csv --plot out.svg --animate run.html >err 2>&1
    status=$?
    reason=
    if [ $status -eq 1 ] && grep -q 'error: unit of .* must be one line of text' err; then
        ! "$gicgen" --report page.html text_$i.veh 2>err || reason="gicgen takes what gicrun refuses"
    elif [ $status -ne 0 ]; then
        reason="exit status $status: $(head -n 2 err)"
    elif ! "$gicgen" --report page.html text_$i.veh 2>err; then
        reason="no report: $(head -n 1 err)"
    elif ! "$gicsweep" -q --engine tape text_$i.veh car.scene --vary p=1:2:2 -o sweep.csv 2>err; then
        reason="no sweep: $(head -n 1 err)"
    else
        reason=$(
            look csv out.csv $i
            look csv sweep.csv $i
            look svg out.svg $i
            look page page.html $i harmless.html
            look page run.html $i harmless_run.html
        )
    fi
    count "$reason" "text $i"
    i=$((i + every))
done
row "texts of models"

# ---- names of files ----
begin
i=0
while [ $i -lt "$names" ]; do
    take_name $i
    rm -rf folder && mkdir folder
    cp car.scene "folder/$name.scene"
    (cd folder && "$gicrun" -q --engine tape ../text_0.veh "./$name.scene" --plot "$name.svg" --animate run.html \
        -o "$name.csv" </dev/null) >err 2>&1
    status=$?
    if [ $status -ne 0 ]; then
        reason="exit status $status: $(head -n 2 err)"
    elif [ ! -f "folder/$name.svg" ] || [ ! -f "folder/$name.csv" ]; then
        reason="a file is missing"
    else
        reason=$(
            look svg "folder/$name.svg" $i
            look page folder/run.html $i harmless_run.html
        )
    fi
    count "$reason" "name $i"
    i=$((i + every))
done
row "names of files"

# ---- a folder for a report, and one that has had one ----
sed 's/^duration: .*/duration: 0.05/; s/^output_step: .*//' "$models/scenes/pendulum.scene" >short.scene
bench() { "$gicbench" --quick --drive --engines tape "$models/pendulum.veh" "$1" -o "$2" >err 2>&1; }
begin
i=0
while [ $i -lt "$names" ]; do
    take_name $i
    rm -rf folder && mkdir folder
    cp short.scene "folder/$name.scene"
    bench "./folder/$name.scene" "./folder/$name"
    status=$?
    reason=
    if [ $status -ne 0 ]; then
        reason="exit status $status: $(head -n 2 err)"
    elif [ ! -f "folder/$name/index.html" ]; then
        reason="no report"
    else
        reason=$(look tables "folder/$name")
    fi
    count "$reason" "folder $i"
    i=$((i + 2 * every))
done
rm -rf report && mkdir report
cat >report/index.html <<END
<!DOCTYPE html>
<title>gicbench</title>
<p><a href="earlier.csv">as CSV</a></p><img src="earlier.svg" alt=""><a href="../short.scene">x</a><a href="notes.txt">x</a>
END
touch report/earlier.csv report/earlier.svg report/theirs.csv report/notes.txt
bench short.scene report
status=$?
reason=
[ $status -eq 0 ] || reason="exit status $status: $(head -n 2 err)"
[ ! -e report/earlier.csv ] && [ ! -e report/earlier.svg ] || reason="an earlier report is left"
[ -e report/theirs.csv ] && [ -e report/notes.txt ] && [ -e short.scene ] || reason="a file of others is gone"
count "$reason" "an earlier report"
row "folders of reports"

# ---- pictures that end too soon ----
begin
mkdir programs
gnuplot=$(command -v gnuplot)
for end in 'head -c 3000' 'head -c 0' 'head -c -8'; do
    for kind in svg png; do
        cat >programs/gnuplot <<END
#!/bin/sh
# the picture ends too soon, and nobody is told
"$gnuplot" "\$@" || exit
for file in *.tmp; do
    $end "\$file" >cut && cat cut >"\$file"
    rm -f cut
done
END
        chmod +x programs/gnuplot
        echo old >old.$kind
        PATH=$work/programs:$PATH "$gicrun" -q --engine tape text_0.veh car.scene --plot old.$kind >out 2>err
        status=$?
        reason=
        [ $status -eq 1 ] && [ "$(grep -c 'error: ' err)" -eq 1 ] || reason="exit status $status: $(tail -n 1 err)"
        [ "$(cat old.$kind)" = old ] || reason="half a picture"
        ! ls ./*.tmp >/dev/null 2>&1 || reason="leaves a file"
        count "$reason" "$end, $kind"
    done
done
row "pictures cut short"
exit $found
