#!/bin/sh
# SPDX-License-Identifier: MIT
# test_bench.sh GICBENCH: a short benchmark from end to end: all files are there and whole, tables can be read, what is
# unstable is called so, errors are those of the integrators. No time is tested but for hanging together with others of
# the same page, which it does on any machine, however busy.
gicbench=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
GICGEN_CACHE=$work/kept
export GICGEN_CACHE

# A cart on a spring: x'' + 2 d x' + w^2 x = 0 with w = 30 / s swings freely, and with d = 300 / s has a fast eigenvalue
# of -598 / s. AB3 is stable on the negative real axis up to 6/11: h < 0.912 ms.
vehicle() {
    cat <<XXX
gicgen: 1
model: cart
gravity: [0, 0, 0]
base: ground
bodies:
  cart: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-9, 9]}
forces:
  spring: {type: spring_damper, coordinate: x, stiffness: 1800, damping: $1}
outputs:
  x: {type: coordinate, coordinate: x}
XXX
}
vehicle 1200 >"$work/stiff.veh"
cat >"$work/cart.scene" <<'XXX'
gicscene: 1
duration: 0.4
step: 0.01
initial: {coordinates: {x: 0.1}}
XXX

"$gicbench" --quick -o "$work/page" "$work/stiff.veh" "$work/cart.scene" "$work/cart.scene" >"$work/out" 2>"$work/err"
check 'a short benchmark ends well' [ $? -eq 0 ]
for file in index.html bench.txt table1.csv table2.csv table3.csv work_precision.csv spin.csv worst.csv \
    operations.csv rhs_operations.csv rhs.csv rhs_step.csv limit.csv start.csv start_steps.csv break_even.csv fig6.svg fig8.svg work_precision.svg break_even.svg; do
    check "$file is there" [ -s "$work/page/$file" ]
done
check 'no temporary file is left' [ -z "$(find "$work/page" -name '*.tmp')" ]
check 'the page is whole' grep -q '^</html>' "$work/page/index.html"
# shellcheck disable=SC2013  # names without spaces
for file in $(sed -n 's/.*\(src\|href\)="\([^"#]*\)".*/\2/p' "$work/page/index.html"); do
    check "the page's $file exists" [ -s "$work/page/$file" ]
done
parts=$(grep -c '^<h2' "$work/page/index.html")
linked=$(sed -n '/<nav>/,/<\/nav>/s/.*href="#\(part[0-9]*\)".*/\1/p' "$work/page/index.html" | while read -r part; do
        grep -c "^<h2 id=\"$part\">" "$work/page/index.html"
    done | grep -cx 1)
check 'there are parts' [ "$parts" -gt 4 ]
check 'contents link to every part' [ "$linked" -eq "$parts" ]
check 'results and contents stand before all else' awk '/<h1/ {h = NR} /class="headline"/ {r = NR} /<nav>/ {n = NR} /<h2/ && !p {p = NR}
    END {exit !(h && h < r && r < n && n < p)}' "$work/page/index.html"
for file in "$work"/page/*.csv; do
    check "$(basename "$file") has as many cells in each row" awk -F, 'NR == 1 {n = NF} NF != n {bad = 1}
        END {exit bad || NR < 2 || n < 3}' "$file"
done
check 'machine, compiler and flags are stated' [ 3 -eq \
    "$(grep -c -e '^Processor: .' -e '^Compiler .*: .' -e '^Its flags: .*-O2' "$work/page/bench.txt")" ]

# all cells of an unstable row say so
check 'AB3 is unstable with 10 and 4 ms' awk -F, 'NR > 1 && ($1 == "10 ms" || $1 == "4 ms") {
    ++n; for (i = 3; i <= NF; ++i) if ($i != "unstable") bad = 1} END {exit bad || n < 2}' "$work/page/table2.csv"
check 'AB3 is stable with 0.5 ms' awk -F, '
    $1 == "0.5 ms" {++n; if (!($3 + 0 > 0 && $3 < 1e-3 && $4 + 0 > 0)) bad = 1}
    END {exit bad || !n}' "$work/page/table2.csv"
# local errors of 1e-9 (1 + 0.1) or less that damping forgets; 1e-7 leaves room for some hundred of them
check 'Adams is stable, its error follows the tolerance' awk -F, '
    NR > 1 {++n; if (!($3 + 0 > 0 && $3 < 100 * $1)) bad = 1}
    END {exit bad || n < 3}' "$work/page/table1.csv"
check 'faster than real time is yes or no' awk -F, 'NR > 1 && $10 !~ /^(yes|no|unstable)$/ {bad = 1} END {exit bad}' \
    "$work/page/table1.csv"

# points SVG: how many are drawn, the legend's included; what is defined before is not
points() { sed '1,/<\/defs>/d' "$1" | grep -c '<use '; }
# drawn FIGURE TABLE: a point for each stable row of the table, and one for each of its engines in the legend
drawn() {
    [ "$(points "$work/page/$1.svg")" -eq "$(awk -F, 'NR > 1 {n += $3 != "unstable"; if (!seen[$2]++) ++n} END {print n}' "$work/page/$2.csv")" ]
}
# with one stable step of three, figures of the two tables differ
check 'figure 6 is of table 1' drawn fig6 table1
check 'figure 8 is of table 2' drawn fig8 table2

# ---- right-hand sides: numbers that must hang together

check 'right-hand sides of every engine, compiled in several ways' awk -F, '
    NR > 1 {++n; if (!($3 <= $2 && $2 <= $4 && $3 > 0)) bad = 1; kind = $1; sub(/ .*/, "", kind); names[kind] = 1
        if ($1 ~ / -O2$/) plain = 1; if ($1 ~ /march=native.*contract=fast$/) fast = 1
        if ($1 ~ /augmented/) augmented = 1; if ($1 ~ /FLOAT/) single = 1}
    END {exit bad || !(plain && fast && augmented && single && names["tcc"] && names["tape"] && names["gic"] &&
        names["gcp1"] && names["gcp2"])}' "$work/page/rhs.csv"
# A time is the median of some repetitions, between the lowest and the highest; so is a ratio, repetition by repetition.
# Whatever else the machine does meanwhile, it is one of the extremes over the other at most, but for the digits printed.
check 'ratios to interpreted engines are those of the times' awk -F, '
    NR == 1 {for (i = 5; i <= NF; ++i) if ($i ~ / over it$/) {name = $i; sub(/ .*/, "", name); column[name] = i}}
    NR > 1 {low[$1] = $3; high[$1] = $4; row[$1] = $0}
    END {for (name in column) for (r in row) {
            split(row[r], cell, ","); ratio = cell[column[name]]; ++n
            if (!(ratio * high[r] > 0.99 * low[name] && ratio * low[r] < 1.01 * high[name])) bad = 1
            if (r == name && ratio != 1) bad = 1}
        exit bad || n < 4 * 13}' "$work/page/rhs.csv"
# two multiply-adds a cycle and register at most, and 0.1 to 10 GHz
check 'the multiply-adds of the processor are plausible' awk -F, '
    NR > 1 {lanes[NR] = $1; if (!($3 <= $2 && $2 <= $4 && $2 > 0.1 * $1 && $2 < 20 * $1)) bad = 1}
    END {exit bad || NR != 3 || lanes[2] != 1 || !(lanes[3] > 1)}' "$work/page/limit.csv"
# the scene's step of 10 ms is ten times what AB3 can take
check 'steps that AB3 can not make have no time' awk -F, 'NR > 1 {++n; if ($2 != "unstable" || $5 != "unstable") bad = 1}
    END {exit bad || n < 4}' "$work/page/rhs_step.csv"
# twice as many operations as multiply-adds, at rates and times between their extremes
check 'limits follow from operations and rates, and parts of them from times' awk -F, '
    function within(value, low, high) {return value > 0.99 * low && value < 1.01 * high}
    FILENAME ~ /operations/ {if ($1 == "all (reduced)") work = $2 + $3; next}
    FILENAME ~ /limit/ {++rates; low[rates] = $3; high[rates] = $4; next}
    FNR == 1 {for (i = 5; i <= NF; ++i) if ($i == "limit [ns]") l = i; next}
    $1 ~ / -O2$/ {for (k = 2; k <= 3; ++k) { # rates: a heading, one at a time, in lanes
            at = l + 2 * (k - 2); ++n
            if (!within($at, work / (2 * high[k]), work / (2 * low[k]))) bad = 1
            if (!within($(at + 1), work / (2 * high[k]) / $4, work / (2 * low[k]) / $3)) bad = 1}}
    $1 !~ /^(tape|gic|gcp)/ {++m; if (!($(l + 1) > 0 && $(l + 3) > 0)) bad = 1}
    END {exit bad || n < 4 || m < 6}' "$work/page/rhs_operations.csv" "$work/page/limit.csv" "$work/page/rhs.csv"
# stiffness times extension, damping times rate, their sum; what else there is belongs to other parts
check 'force laws are counted apart' grep -qx 'force laws,1,2,0,0,0' "$work/page/rhs_operations.csv"

# ---- generated against interpreted: numbers that must hang together, whatever the machine

# The compiler's time is part of that from file to first step; medians stand between extremes; compiler and gicbench
# use two processors at most.
check 'starts are measured for every engine' awk -F, '
    NR > 1 {++n; names = names " " $1; for (i = 2; i < 11; i += 3) if (!($(i + 1) <= $i && $i <= $(i + 2))) bad = 1
        if (!($2 <= $5 && $5 > 0 && $6 <= 2 * $10)) bad = 1}
    END {exit bad || names != " cc cc (kept) tcc tape gic gcp1 gcp2"}' "$work/page/start.csv"
check 'cc and tcc compile, what is kept or interpreted is not compiled' awk -F, '
    NR > 1 && ($1 == "cc" || $1 == "tcc") != ($2 > 0) {bad = 1} END {exit bad || NR != 8}' "$work/page/start.csv"
check 'a kept object starts sooner at best than a compiler does at worst' awk -F, '
    $1 == "cc" {compiled = $10} $1 == "cc (kept)" {kept = $9}
    END {exit !(kept > 0 && kept < compiled)}' "$work/page/start.csv"
# the object itself, one of those of all variants, says how large it is: segments end within a page of the sections that
# they hold
bytes=$(find "$GICGEN_CACHE" -name "*.so" -exec size {} + | awk '$4 + 0 > 0 {printf "%d ", $4}')
check 'code and constants are as large as in the object' awk -F, -v bytes="$bytes" '
    function kept(size) {for (i = split(bytes, b, " "); i; --i) if (size > b[i] && size < b[i] + 4096) return 1}
    $1 == "cc" || $1 == "cc (kept)" {++n; if (!kept($11 * 1000)) bad = 1}
    $1 == "tcc" && !($11 > 1 && $11 < 1000) {bad = 1}
    $1 ~ /^(tape|gic|gcp)/ && $11 != "-" {bad = 1}
    END {exit bad || n != 2}' "$work/page/start.csv"
check 'right-hand sides and steps take time' awk -F, '
    NR > 1 {for (i = 2; i <= 10; ++i) if (!($i > 0)) bad = 1} NR == 2 && $8 != 1 {bad = 1}
    END {exit bad || NR != 8}' "$work/page/start_steps.csv"
# extremes of all starts and steps say how soon at best
check 'break-even follows from starts and steps' awk -F, '
    FILENAME ~ /start.csv/ {low[$1] = $6; high[$1] = $7; next}
    FILENAME ~ /start_steps.csv/ {fast[$1] = $6; slow[$1] = $7; next}
    FNR == 1 {for (i = 2; i < NF; i += 3) name[i] = $i; next}
    {for (i = 2; i < NF; i += 3) {
        ++n
        gain = 1.001 * slow[name[i]] - 0.999 * fast[$1] # cells have four digits
        least = (0.999 * low[$1] - 1.001 * high[name[i]]) * 1000 / gain
        if ($i != "never" && !(gain > 0 && $i >= 1 && $(i + 1) >= least)) bad = 1}}
    END {exit bad || n != 12}' "$work/page/start.csv" "$work/page/start_steps.csv" "$work/page/break_even.csv"

# an undamped one: the order of AB3 shows, eight times less error for half the step: 512 times from 4 to 0.5 ms
vehicle 0 >"$work/soft.veh"
mkdir "$work/page/part" "$work/page/other"
cp "$work/page/index.html" "$work/page/part"
echo '<title>another</title>' >"$work/page/other/index.html"
"$gicbench" --quick --engines cc,tape -o "$work/page" "$work/soft.veh" "$work/cart.scene" >"$work/out" 2>"$work/err"
check 'a folder may be there already' [ $? -eq 0 ]
check 'it links to reports in folders within it, and to nothing else' [ "$(grep -o '[a-z]*/index.html' "$work/page/index.html")" = part/index.html ]
leads() { grep -qF '<a href="../index.html">' "$work/page/part/index.html" && grep -q '^</html>' "$work/page/part/index.html"; }
check 'and they lead back to it' leads
nowhere() { ! grep -q 'href="../index.html"' "$work/page/index.html" "$work/page/other/index.html"; }
check 'pages that are within no report lead nowhere' nowhere
check 'the first result compares the engines' grep -q "^\* ab3 with steps of .*: cc is [0-9.e+]* times as fast as tape" "$work/page/bench.txt"
check 'the order of AB3 shows' awk -F, '$1 == "4 ms" {coarse = $3} $1 == "0.5 ms" {fine = $3}
    END {exit !(fine > 0 && coarse > 100 * fine)}' "$work/page/table2.csv"
check 'without a second scene there is no table of it' \
    [ "$(grep -c 'A vehicle that turns' "$work/page/bench.txt")" -eq 0 ]

# ---- right-hand sides alone

# rhs MODEL...: the text in $work/out
rhs() {
    "$gicbench" --rhs --quick --engines cc,tape "$@" >"$work/out" 2>"$work/err"
}

# operations PART: of a row of the table
operations() {
    sed -n "s/^$1  *\([0-9]\)/\1/p" "$work/out" | tr -s ' '
}

# three more products and a sum, of the law alone: the rest of the cart stays as it is
{ vehicle 1200 | sed '/^outputs/,$d'; echo '  cubic: {type: force, coordinate: x, value: "0.25 * x^3"}'; } >"$work/cubic.veh"
plain=$(sed -n 's/^equations of motion (reduced),//p' "$work/page/rhs_operations.csv" | tr , ' ')
rhs -o "$work/cubic" "$work/cubic.veh" "$work/cart.scene"
check 'right-hand sides alone' [ $? -eq 0 ]
check 'a cubic law costs three products and a sum' [ "$(operations 'force laws')" = '2 5 0 0 0' ]
check 'equations of motion do not depend on laws' [ "$(operations 'equations of motion (reduced)')" = "$plain" ]
check 'the folder has what is printed' cmp "$work/out" "$work/cubic/bench.txt"

# a box on four tires, without a scene
cat >"$work/box.veh" <<XXX
gicgen: 1
model: box
base: box
bodies:
  box: {mass: 4000, com: [0, 0, 1], inertia: [3000, 3000, 3000]}
tires:
  all: {file: $(cd "$(dirname "$0")/../../models/tires" && pwd)/hmmwv_pac2002.tir}
wheels:
  fl: {body: box, center: [1, 1, 0.45], tire: all, spin_inertia: 7}
  fr: {body: box, center: [1, -1, 0.45], tire: all, spin_inertia: 7}
  rl: {body: box, center: [-1, 1, 0.45], tire: all, spin_inertia: 7}
  rr: {body: box, center: [-1, -1, 0.45], tire: all, spin_inertia: 7}
XXX
rhs -o "$work/box" "$work/box.veh"
check 'a box on tires' [ $? -eq 0 ]
check 'a fast step has a time of its own for every variant' awk -F, '
    FNR == 1 {++files; next} !($3 > 0 && $3 <= $2 && $2 <= $4) {bad = 1} {seen[$1] += files}
    END {for (name in seen) {++n; if (seen[name] != 3) bad = 1} exit bad || n < 8}' "$work/box/rhs.csv" "$work/box/rhs_fast.csv"

# Compilers of the names cc and clang that keep the code they are given and leave the work to the usual one.
mkdir "$work/programs" "$work/given"
for name in cc clang; do
    cat >"$work/programs/$name" <<XXX
#!/bin/sh
for word; do case \$word in *model.c) cp "\$word" "$work/given/$name.\$\$" ;; esac; done
exec $(command -v "${CC:-cc}") "\$@"
XXX
    chmod +x "$work/programs/$name"
done
# watched OPTION...: gicbench with these compilers
watched() { PATH=$work/programs:$PATH GICGEN_CACHE='' "$gicbench" --quick --engines cc "$@" >"$work/out" 2>"$work/err"; }
# where clang is the command line's compiler, what clang does besides is not done once more
watched --rhs --cc clang "$work/box.veh"
check 'right-hand sides by clang' [ $? -eq 0 ]
check 'a way is there once' [ -z "$(sed -n 's/^\(clang .*[^ ]\)   *[0-9].*/\1/p' "$work/out" | sort | uniq -d)" ]

# a scene as it stands: shares of a step, which no clock inside takes
models=$(cd "$(dirname "$0")/../../models" && pwd)
sed 's/^duration: 30/duration: 0.6/' "$models/scenes/full_run.scene" >"$work/drive.scene"
drive() { "$gicbench" --drive --quick --engines tape,gic "$@" >"$work/out" 2>"$work/err"; }
drive -o "$work/drive" "$models/hmmwv_vehicle.veh" "$work/drive.scene"
check 'a scene as it stands' [ $? -eq 0 ]
check 'it is printed too' grep -q 'Where the time of a step goes' "$work/out"
# parts are timed one by one, and what is left of a step is whatever they miss; cells have two or three digits
# parts have three digits, the rest two
check 'parts are not negative and add up to the step; tires and driveline have their share' awk -F, '
    function apart(a, b) {return a > b ? a - b : b - a}
    NR > 1 {++n; parts = $7 + $8 + $9; if (!($2 > 0 && $7 > 0 && $8 > 0 && $9 >= 0 && $10 >= 0)) bad = 1
        if (apart(parts + $10, $6) > 0.005 * (parts + $6) + 0.05 * ($9 + $10)) bad = 1
        if (apart($11, 100 * ($8 + $9) / $6) > 1 + 0.06 * $11) bad = 1}
    END {exit bad || n != 2}' "$work/drive/drive.csv"
printf 'gicscene: 1\nduration: 0.2\nstep: 0.004\nratio: 4\ninitial: {velocity: [10, 0, 0]}\n' >"$work/box.scene"
"$gicbench" --drive --quick --engines cc -o "$work/lanes" "$work/box.veh" "$work/box.scene" >"$work/out" 2>"$work/err"
check 'wheels in lanes beside wheels one by one, with the same results' awk -F, '
    NR > 1 {++n; lanes += /lanes/; if (!($2 > 0 && $12 > 0 && $15 <= 1e-9)) bad = 1}
    END {exit bad || n < 3 || !lanes}' "$work/lanes/drive.csv"
# clang compiles the same code as cc: one by one, and in four lanes
rm -f "$work/given"/*
watched --drive --cc cc -o "$work/given_page" "$work/box.veh" "$work/box.scene"
check 'a drive with both compilers' [ $? -eq 0 ]
same_code() {
    for code in "$work/given"/clang.*; do
        for other in "$work/given"/cc.*; do ! cmp "$code" "$other" >"$work/said" || continue 2; done
        return 1
    done
}
check 'clang compiles what cc does' same_code
drive "$work/soft.veh" "$work/cart.scene"
check 'a model without wheels: multibody alone' grep -q '^tape .* 0 *0 *[-0-9.e]* *0 *1 *1 *1 *0$' "$work/out"
# ---- in lanes

# four sledges in one vector of four: it does at least a fourth of what they need one by one, and no more than each of
# them alone; without forces there is less to do
rhs -o "$work/sledges" "$(dirname "$0")/../data/pivots/sledges.veh"
check 'alike parts in lanes' [ $? -eq 0 ]
check 'operations in lanes are a fourth of those one by one, or some more' awk -F, '
    FILENAME ~ /operations/ {if ($1 == "all (reduced)") all = $2 + $3; next}
    FNR > 1 && !/newton/ {++n; if (!(4 * $2 + $3 >= all && $2 + $3 < all && $4 <= $2 && $5 <= $3 && $4 > 0)) bad = 1}
    END {exit bad || n < 1}' "$work/sledges/rhs_operations.csv" "$work/sledges/rhs_lanes.csv"

"$gicbench" --batch 8 --quick "$work/soft.veh" "$work/cart.scene" >"$work/out" 2>"$work/err"
check 'vehicles in lanes' [ $? -eq 0 ]
check 'it says how long many vehicles take' grep -q '^this will take about [0-9]*:[0-9][0-9]$' "$work/err"
check 'all ways have times, and the same states' awk '/^way / {on = 1; next} on && NF {++n; if (!($(NF - 2) > 0 && $NF == 0)) bad = 1}
    END {exit bad || n < 5}' "$work/out"

# ---- scenes with code for each: a drive, a rig, a vehicle that sleeps, all of them short

cut() { sed "s/^duration: .*/duration: $2/" "$models/scenes/$1.scene" >"$work/$1.scene"; }
cut constant_steer 0.6
cut quarter_car 1
cut parked 30
"$gicbench" --scenes --quick --engines tcc -o "$work/scenes" "$models/hmmwv_vehicle.veh" "$work/constant_steer.scene" \
    "$models/quarter_car.veh" "$work/quarter_car.scene" "$models/hmmwv_vehicle.veh" "$work/parked.scene" >"$work/out" 2>"$work/err"
check 'scenes' [ $? -eq 0 ]
check 'it is printed too' grep -q 'General and specialised' "$work/out"
check 'operations, times and ratios hang together' awk -F, '
    NR == 1 {for (i = 1; i <= NF; ++i) at[$i] = i; next}
    {++n; ratio = $at["time ratio"]; work = $at["specialised [M/s]"] / $at["general [M/s]"]; said = $at["operations ratio"]
        if (!($at["rhs specialised"] > 0 && $at["rhs specialised"] <= $at["rhs general"])) bad = 1
        if (!($at["lowest"] <= ratio && ratio <= $at["highest"] && $at["lowest"] > 0)) bad = 1
        if (!($at["general [ms]"] > 0 && $at["specialised [ms]"] > 0)) bad = 1
        if (!(work <= 1 && said > 0.99 * work && said < 1.01 * work)) bad = 1}
    END {exit bad || n != 3}' "$work/scenes/scenes.csv"
# the same operations but for those with constants: rounding, grown in a second
check 'what is exact differs by rounding' awk -F, '
    NR == 1 {for (i = 1; i <= NF; ++i) at[$i] = i; next}
    $1 != "parked.scene" {++n; if (!($at["difference"] < 1e-9)) bad = 1} END {exit bad || n != 2}' "$work/scenes/scenes.csv"
# it rests within 1e-4 of its state; tires make 1e5 N of a slip of 1
check 'what sleeps hardly moves' awk -F, '
    NR == 1 {for (i = 1; i <= NF; ++i) at[$i] = i; next}
    $1 == "parked.scene" {++n; if (!($at["difference"] < 1e-2 && $at["operations ratio"] < 0.05 && /asleep [1-9]/)) bad = 1}
    END {exit bad || n != 1}' "$work/scenes/scenes.csv"

# ---- run time against error: a change of gear, the cart's single events, refusals

cut full_run 3.6
precision() { "$gicbench" --precision --quick --engines tcc "$@" >"$work/out" 2>"$work/err"; }
sed '/^step/s/0.01/0.004/; $a ratio: 2\noutput_step: 0.02' "$work/cart.scene" >"$work/swing.scene"
precision -o "$work/precision.csv" --plot "$work/precision.svg" "$models/hmmwv_vehicle.veh" "$work/full_run.scene" \
    "$work/soft.veh" "$work/swing.scene"
check 'run time against error of two models' [ $? -eq 0 ]
check 'it is printed too' grep -q 'full_run.scene, hmmwv_vehicle.veh' "$work/out"
check 'the picture has a part for each scene' [ 2 -eq "$(grep -o ': CPU time against error' "$work/precision.svg" | wc -l)" ]
# fields (quotes around the names of ways taken away): model, scene, way, step or tolerance, error, order, times, counts
sed 's/"\(ab3\), \([^",]*\), late gears"/\1 \2 late/; s/"\(ab3\), \([^"]*\)"/\1 \2/; s/"rk4, late gears"/rk4 late/' \
    "$work/precision.csv" >"$work/rows.csv"
check 'every way has its rows, a time and its spread' awk -F, '
    NF != 11 {bad = 1} NR > 1 {++seen[$2 "," $3]}
    NR > 1 && $7 != "-" {if (!($8 > 0 && $8 <= $7 && $7 <= $9 && $10 > 0)) bad = 1; if (/dual/ != ($11 > 0)) bad = 1}
    END {split("ab3 one rate,ab3 dual rate 1:6,rk4,ab3 one rate late,ab3 dual rate 1:6 late,rk4 late,adams,rkck", way, ",")
        for (i in way) if (seen["full_run.scene," way[i]] != 4) bad = 1
        for (i = 1; i < 9; ++i) if (i % 2 && i != 5 && seen["swing.scene," way[i]] != 4) bad = 1
        exit bad || NR != 1 + 8 * 4 + 4 * 4}' "$work/rows.csv"
# x = 0.1 cos(30 t): AB3 has order 3, RK4 order 4, and an error of the whole phase at most
check 'the orders of AB3 and RK4 show where nothing jumps' awk -F, '
    $2 == "swing.scene" && $6 != "-" {++n; most = $3 == "rk4" ? 4 : 3; if (!($6 > most - 0.4 && $6 < most + 0.4)) bad = 1}
    END {exit bad || n < 6}' "$work/rows.csv"
# AB3: 3/8 (w h)^4 each step, w t / (w h) steps, of 0.1 m; RK4: (w h)^5 / 120
check 'and so do their errors' awk -F, '
    function about(x, y) {return x > 0.7 * y && x < 1.3 * y}
    $2 == "swing.scene" && $4 == "0.5 ms" {++n; p = 30 * 0.0005
        if (!about($5, 0.1 * 12 * ($3 == "rk4" ? p^4 / 120 : 3 / 8 * p^3))) bad = 1}
    END {exit bad || n != 2}' "$work/rows.csv"
check 'tolerances bring variable steps nearer' awk -F, '
    $2 == "swing.scene" && $4 == "0.001" {loose[$3] = $5} $2 == "swing.scene" && $4 == "1e-07" {tight[$3] = $5}
    END {exit !(tight["adams"] < loose["adams"] / 100 && tight["rkck"] < loose["rkck"] / 100)}' "$work/rows.csv"
# a step too late at 4 m/s^2 and some 10 m/s: millimetres; located: none
check 'gears within steps leave a tenth of the error of late ones' awk -F, '
    $2 == "full_run.scene" && $4 == "1.5 ms" {error[$3] = $5}
    END {for (way in error) if (way !~ /late/) {++n; if (!(10 * error[way] < error[way " late"])) bad = 1}
        exit bad || n != 3}' "$work/rows.csv"
check 'the reference says how uncertain it is' [ 2 -eq "$(grep -c 'Reference: rkck .* differs by .* from adams .* from rk4' "$work/out")" ]

# a stiff mount, 159 Hz, by implicit ways as well: ros2 has order 2 and ros3 order 3, with one Jacobian as with many, for it
# is linear; times at equal errors are between those of the rows beside them, and ratios are of these times
cat >"$work/mount.veh" <<'END'
gicgen: 1
model: mount
gravity: [0, 0, 0]
base: ground
bodies: {b: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}}
joints: {j: {type: prismatic, bodies: [ground, b], axis: [1, 0, 0]}}
coordinates: {x: {type: translation, bodies: [ground, b], axis: [1, 0, 0], range: [-1, 1]}}
forces:
  rubber: {type: bushing, bodies: [ground, b], point: [0, 0, 0], stiffness: [2e6, 0, 0, 0, 0, 0], damping: [400, 0, 0, 0, 0, 0]}
END
printf 'gicscene: 1\nduration: 0.1\nstep: 0.0005\noutput_step: 0.01\nintegrator: ros3\nkeep_jacobian: 4\n' >"$work/mount.scene"
echo 'initial: {coordinates: {x: 0.001}}' >>"$work/mount.scene"
precision -o "$work/stiff" "$work/mount.veh" "$work/mount.scene"
check 'a stiff vehicle' [ $? -eq 0 ]
sed 's/"\(ros[23]\|imex\), [^"]*"/\1 kept/; s/"ab3, one rate"/ab3/' "$work/stiff/precision1.csv" >"$work/rows.csv"
sed 's/"\(ros[23]\|imex\), [^"]*"/\1 kept/; s/"ab3, one rate"/ab3/' "$work/stiff/equal1.csv" >"$work/equal.csv"
check 'imex is among them, with and without kept Jacobians' [ 2 -eq "$(grep -c '"*imex.*"*0.0625 ms' "$work/rows.csv")" ]
check 'implicit ways have their orders' awk -F, '$3 ~ /^ros/ && $4 == "0.0625 ms" {++n; d = $6 - substr($3, 4, 1)
    if (d < -0.2 || d > 0.2) bad = 1} END {exit bad || n != 4}' "$work/rows.csv"
check 'bdf comes nearer with its tolerance' awk -F, '$3 == "bdf" {++n; if (n > 1 && !($5 < before / 10)) bad = 1; before = $5}
    END {exit bad || n != 4}' "$work/rows.csv"
check 'times at equal errors are those of the rows beside them' awk -F, '
    NR == FNR {if ($5 + 0 > 0 && $5 !~ /below/) {k = ++rows[$3]; error[$3, k] = $5; low[$3, k] = $8; high[$3, k] = $9} next}
    FNR > 1 {++n; for (k = 1; k <= rows[$4] && error[$4, k] > $3; ++k) ; j = k > 1 ? k - 1 : 1
        least = low[$4, j] < low[$4, k] ? low[$4, j] : low[$4, k]; most = high[$4, j] > high[$4, k] ? high[$4, j] : high[$4, k]
        if (k > rows[$4] || !($6 >= 0.999 * least && $7 <= 1.001 * most && $6 <= $5 && $5 <= $7)) bad = 1
        if ($4 == "ab3") {a = $5; b = $6; c = $7; at = $3; if (!($8 == 1 && $9 == 1 && $10 == 1)) bad = 1}
        else if (at == $3 && !($9 <= $8 && $8 <= $10 && $9 >= 0.999 * $6 / c && $10 <= 1.001 * $7 / b)) bad = 1
        else if (at != $3 && $8 != "-") bad = 1; ++way[$4]}
    END {for (w in way) ++ways; exit bad || ways != 11}' "$work/rows.csv" "$work/equal.csv"
# a wheel that hops and a load between stops: with and without location, side by side
printf 'gicscene: 1\nduration: 1\nstep: 0.002\noutput_step: 0.02\n' >"$work/hop.scene"
echo 'initial: {coordinates: {z: 0.05}, rates: {s: 0.8}}' >>"$work/hop.scene"
precision -o "$work/hop.csv" "$(dirname "$0")/../data/contact/hop.veh" "$work/hop.scene"
check 'contacts located and gone over' [ $? -eq 0 ]
check 'RK4 has a hundredth of the error with them' awk -F '"?,"?' '
    /rk4,/ || /"rk4, contacts/ {
        located = /contacts located/
        error[located] = $(located ? 6 : 5)
        ++n
    }
    END {exit !(n == 8 && error[1] > 0 && error[1] < error[0] / 100)}' "$work/hop.csv"

# ---- in the browser

/usr/bin/python3 -B "$(dirname "$0")/../bench/width.py" "$work/profile" "$work/page/index.html" "$work/box/index.html" \
    "$work/drive/index.html" "$work/lanes/index.html" "$work/scenes/index.html" >"$work/notes" 2>"$work/err"
check 'the browser is used to the end' [ $? -eq 0 ]
while read -r how what; do
    check "$what" [ "$how" = good ]
done <"$work/notes"

# fails STATUS TEXT ARGUMENT...
fails() {
    status=$1
    text=$2
    shift 2
    "$gicbench" "$@" >"$work/out" 2>"$work/err"
    check "exit status $status: $text" [ $? -eq "$status" ]
    check "message: $text" grep -q "error: .*$text" "$work/err"
    check "remedy: $text" grep -q 'remedy: ' "$work/err"
}
fails 2 'a model and a scene' "$work/soft.veh"
fails 2 'a model, please' --rhs
fails 2 'a model and a scene' --drive "$work/soft.veh"
fails 2 'one of --rhs, --drive' --rhs --drive "$work/soft.veh" "$work/cart.scene"
fails 2 'several pairs' --scenes "$work/soft.veh" "$work/cart.scene" "$work/soft.veh"
sed 's/^step.*/integrator: adams\noutput_step: 0.01/' "$work/cart.scene" >"$work/variable.scene"
fails 1 'constant steps' --scenes --engines tcc "$work/soft.veh" "$work/variable.scene"
fails 1 'constant steps' --drive --engines tape "$work/soft.veh" "$work/variable.scene"
for count in x 5.7 0 65537 1e3 99999999999999999999; do
    fails 2 '1 to 65536 vehicles' --batch "$count" "$work/soft.veh" "$work/cart.scene"
done
fails 2 "generated code.*'gic'" --scenes --engines gic "$work/soft.veh" "$work/cart.scene"
fails 2 "no engine 'fast'" --engines fast "$work/soft.veh" "$work/cart.scene"
fails 2 'at least one name' --engines '' "$work/soft.veh" "$work/cart.scene"
fails 1 "can't make the folder" -o "$work/no/page" "$work/soft.veh" "$work/cart.scene"
sed 's/0.4$/0.03/' "$work/cart.scene" >"$work/short.scene"
fails 1 "the engine 'tape' has no derivatives" --precision --engines tape "$work/mount.veh" "$work/mount.scene"
fails 2 'a model and its scenes' --precision "$work/soft.veh"
fails 2 'a scene is missing' --precision "$work/soft.veh" "$work/cart.scene" "$work/soft.veh"
fails 2 'writes .svg or .png' --precision --plot "$work/picture.pdf" "$work/soft.veh" "$work/cart.scene"
fails 2 'goes with --precision' --drive --plot "$work/picture.svg" "$work/soft.veh" "$work/cart.scene"
# what is wrong with the second scene is said before the first one runs
refused() {
    rm -f "$work/precision.csv"
    fails 1 "$1" --precision --engines tcc -o "$work/precision.csv" "$work/soft.veh" "$work/cart.scene" "$2"
    check "one message, and nothing else: $1" [ 1 -eq "$(grep -c 'error: ' "$work/err")" ]
    nothing_left() { [ ! -e "$work/precision.csv" ] && [ ! -s "$work/out" ]; }
    check "no results: $1" nothing_left
}
refused "can't open" "$work/missing.scene"
refused 'hmmwv_vehicle' "$models/scenes/full_run.scene"
sed '/^duration/d' "$work/cart.scene" >"$work/endless.scene"
refused 'duration' "$work/endless.scene"
refused 'no step' "$work/variable.scene"
{ cat "$work/cart.scene"; echo 'until: x < 0'; } >"$work/until.scene"
refused 'conditions' "$work/until.scene"
for file in '-o no/rows.csv' '--plot no/picture.svg'; do
    # shellcheck disable=SC2086  # two words
    fails 1 "can't create no" --precision --engines tcc $file "$work/soft.veh" "$work/cart.scene"
done
fails 1 'at least' -o "$work/page" "$work/soft.veh" "$work/short.scene"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
