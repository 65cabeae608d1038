#!/bin/sh
# SPDX-License-Identifier: MIT
# test_tir.sh GICGEN: `.tir` files. The numbers of the HMMWV's tire are those that a reader of its own (tir.py) finds in
# the file; other units, line ends and spacing change nothing; every broken file is refused at its place with a remedy,
# and no bytes whatever crash the reader.
case $1 in /*) gicgen=$1 ;; *) gicgen=$PWD/$1 ;; esac
root=$(cd "$(dirname "$0")/../.." && pwd)
good=$root/models/tires/hmmwv_pac2002.tir
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
cd "$work" || exit 1

cat >cart.veh <<'END'
gicgen: 1
model: cart
base: box
bodies:
  box: {mass: 10, com: [0, 0, 1], inertia: [10, 10, 10]}
tires:
  all: {file: t.tir}
wheels:
  left: {body: box, center: [0, 1, 0.4], tire: all, spin_inertia: 1}
END

# reads LABEL: t.tir is read without a word
reads() {
    "$gicgen" --dump-model cart.veh >dump 2>err && [ ! -s err ]
    verdict $? "$1: $(cat err)"
}

# same LABEL: and gives the numbers of the HMMWV's tire
same() {
    reads "$1"
    cmp -s dump plain
    verdict $? "$1: other numbers"
}

# broken SCRIPT LINE COLUMN MESSAGE REMEDY: the tire that sed's SCRIPT spoils is refused at the first line that begins
# with LINE
broken() {
    sed "$1" "$good" >t.tir
    refused "$2" "$3" "$4" "$5" "$1"
}

refused() {
    line=$(grep -naF -e "$1" t.tir | head -n 1 | cut -d: -f1)
    "$gicgen" --dump-model cart.veh >dump 2>err
    [ $? -eq 1 ] && [ ! -s dump ] && [ "$(grep -c 'error: ' err)" -eq 1 ] && grep -q '^  *^$' err &&
        grep -qF -e "t.tir:${line:-none}:$2: error: " err && grep 'error: ' err | grep -qF -e "$3" &&
        grep '^  remedy: ' err | grep -qF -e "$4"
    verdict $? "$5: not '$1':$2 '$3' '$4' but $(head -c 600 err)"
}

# ---- what is right ---------------------------------------------------------------------------------------------------

cp "$good" t.tir
reads 'the file of the HMMWV'
cp dump plain
/usr/bin/python3 "$root/tests/tools/tir.py" numbers "$good" dump >said 2>&1
verdict $? "numbers: $(tail -n 1 said)"

# units: 1e-15 is a few roundings of one multiplication and one division
for units in 'mm kN degree second' 'millimeter kilonewton deg ms' 'cm N radians minute' 'inch lbf degrees s'; do
    # shellcheck disable=SC2086  # four words
    /usr/bin/python3 "$root/tests/tools/tir.py" convert "$good" $units >t.tir
    reads "units $units"
    cmp -s t.tir "$good"
    verdict $((! $?)) "units $units: the file is the same"
    /usr/bin/python3 "$root/tests/tools/tir.py" same plain dump 1e-15 >said 2>&1
    verdict $? "units $units: $(tail -n 1 said)"
done

sed 's/$/\r/' "$good" >t.tir
same 'CR LF'
tr '\n' '\r' <"$good" >t.tir
same 'CR'
{ printf '\357\273\277' && cat "$good"; } >t.tir
same 'byte order mark'
sed 's/ = /\t=  /; s/$/  $ a comment = [with] '"'"'quotes/; s/^\[/\n \t[ /; s/\]/ ]/' "$good" >t.tir
same 'tabs, blanks and comments'
sed 's/^\([A-Z0-9_]* = [^'"'"' ]*\)$/\L\1!comment/; s/^\[.*/\L&/; s/METER/Meter/' "$good" >t.tir
same 'small letters'
{ cat "$good" && printf '[SHAPE]\n{radial width}\n 1.0 0.0\n 1.0 1.0\n(COMMENTS)\n{comment_string}\n'"'PCX1 = 3'"'\n'; } >t.tir
same 'tables'
{ cat "$good" && head -c 10000 /dev/zero | tr '\0' '$'; } >t.tir
same 'a comment of 10 kB without an end of line'

# a scale that is absent is 1
for scale in LCZ LFZO LMUX LKY; do
    sed "s/^$scale = .*/$scale = 1/" "$good" >t.tir
    reads "$scale = 1"
    cp dump one
    sed "/^$scale = /d" "$good" >t.tir
    reads "without $scale" && cmp -s dump one
    verdict $? "without $scale: other numbers than with 1"
done

# what a mode does not need may be absent
sed 's/^USE_MODE.*/USE_MODE = 11/; /^P[CDK]Y/d' "$good" >t.tir
reads 'USE_MODE 11 without lateral coefficients'
sed 's/^USE_MODE.*/USE_MODE = 2/; /^P[CDK]X/d' "$good" >t.tir
reads 'USE_MODE 2 without longitudinal coefficients'
sed 's/^USE_MODE.*/USE_MODE = 0/; /^[PQRS][A-Z]*[XYZ][0-9]/d' "$good" >t.tir
reads 'USE_MODE 0 without coefficients'
sed "s/^PROPERTY_FILE_FORMAT.*/FITTYP = 6/; /_MODE/d; /^[AC][LA][PM]M/d; /^KP/d; /^FZ/d" "$good" >t.tir
reads 'MF5.2 without ranges and mode'

# unknown keys are named and ignored
sed 's/^PCX1 = .*/&\nPXC1 = 3/' "$good" >t.tir
"$gicgen" --dump-model cart.veh >dump 2>err && cmp -s dump plain && grep -q "t.tir:[0-9]*:1: warning: .*'PXC1'" err &&
    grep -q "remedy: did you mean 'PCX1'?" err
verdict $? "an unknown key: $(cat err)"
{ cat "$good" && seq -f 'NOTHING_%.0f = 1' 1000; } >t.tir
"$gicgen" --dump-model cart.veh >dump 2>err && [ "$(grep -c warning err)" -eq 11 ] && grep -q '990 more' err
verdict $? 'a thousand unknown keys'

# ---- what is wrong ---------------------------------------------------------------------------------------------------

broken 's/^PCX1 = .*/PCX1 = steep/' PCX1 8 "PCX1 of tire 'all' must be a number, not 'steep'" 'decimal number'
broken 's/^PCX1 = .*/PCX1 = 1,72/' PCX1 8 "must be a number, not '1,72'" 'write 1.72'
broken 's/^PCX1 = .*/PCX1 =1.72D0/' PCX1 7 "must be a number, not '1.72D0'" 'write 1.72e0'
broken 's/^PCX1 = .*/PCX1 = NaN/' PCX1 8 "must be a number, not 'NaN'" 'finite'
broken 's/^PCX1 = .*/PCX1 = -inf/' PCX1 8 "must be a number, not '-inf'" 'finite'
broken 's/^PCX1 = .*/PCX1 = 0x1p3/' PCX1 8 "must be a number, not '0x1p3'" 'decimal'
broken 's/^PCX1 = .*/PCX1 = 1e999/' PCX1 8 '1e999 is too large' '1.8e308'
broken "s/^PCX1 = .*/PCX1 = '1.72'/" PCX1 8 'must be a number, not a text' 'remove the quotes'
broken 's/^PCX1 = .*/PCX1 = $ 1.72/' PCX1 8 "PCX1 of tire 'all' has no value" 'PCX1 = value'
broken 's/^PCX1 = .*/PCX1 = 1.72 N/' PCX1 13 "'N' is unexpected" 'comments with $'
broken 's/^PCX1 = .*/PCX1 1.72/' 'PCX1 1' 1 'neither a [SECTION] nor KEY = value' 'KEY = value'
broken 's/^PCX1 = .*/= 1.72/' '= 1.72' 1 'neither a [SECTION] nor KEY = value' 'KEY = value'
broken 's/^PCX1 = .*/&\npcx1 = 2/' 'pcx1' 1 "'PCX1' is in line" 'take one of the two away'
broken '/^PKY1/d' '[LATERAL_COEFFICIENTS]' 1 '[LATERAL_COEFFICIENTS] lacks PKY1' 'PKY1 = number'
broken '/^FNOMIN/d' '[VERTICAL]' 1 '[VERTICAL] lacks FNOMIN' 'FNOMIN = number'
broken '/^\[LATERAL/,/^\[ROLL/d' '! SPDX' 1 'the section [LATERAL_COEFFICIENTS] with PCY1 is missing' 'to [LATERAL_COEFFICIENTS]'
broken '/^\[DIMENSION/,/^RIM_WIDTH/d' '! SPDX' 1 'the section [DIMENSION] with UNLOADED_RADIUS' 'to [DIMENSION]'
broken '/^\[UNITS/,/^PRESSURE/d' '! SPDX' 1 'the section [UNITS] with LENGTH is missing' "LENGTH = 'meter'"
broken '/^FORCE/d' '[UNITS]' 1 '[UNITS] lacks FORCE' "FORCE = 'newton'"
broken "s/^LENGTH.*/LENGTH = 'furlong'/" LENGTH 10 "'furlong' is no unit of LENGTH" 'one of: meter,'
broken "s/^FORCE.*/FORCE = 'meter'/" FORCE 9 "'meter' is no unit of FORCE" 'one of: newton,'
broken "s/^MASS.*/MASS = 7/" MASS 8 "'7' is no unit of MASS" 'one of: kg,'
broken "s/^PROPERTY.*/PROPERTY_FILE_FORMAT = 'FTIRE'/" PROPERTY 24 "'FTIRE' is another tire model" 'PAC2002'
broken "s/^PROPERTY.*/&\nFITTYP = 61/" FITTYP 10 'FITTYP 61 is another tire model' 'FITTYP 5'
broken '/^PROPERTY/d' '[MODEL]' 1 '[MODEL] lacks PROPERTY_FILE_FORMAT' "'PAC2002'"
broken 's/^USE_MODE.*/USE_MODE = -4/' USE_MODE 12 'USE_MODE -4 asks for a mirrored tire' 'side: left'
broken 's/^USE_MODE.*/USE_MODE = 7/' USE_MODE 12 'USE_MODE 7 is not one of' 'write 4'
broken 's/^USE_MODE.*/USE_MODE = 2.5/' USE_MODE 12 'USE_MODE 2.5 is not one of' 'write 4'
broken 's/^USE_MODE.*/USE_MODE = 25/' USE_MODE 12 'USE_MODE 25 is not one of' 'write 4'
broken "s/^TYRESIDE.*/TYRESIDE = 'TOP'/" TYRESIDE 12 "no TYRESIDE 'TOP'" 'SYMMETRIC'
broken "s/^TYRESIDE.*/TYRESIDE = 'LEFT/" TYRESIDE 12 'the quotes are not closed' 'same line'
broken 's/^\[MODEL\].*/[MODEL/' '[MODEL' 1 'not closed by ]' '[NAME]'
broken 's/^\[MODEL\].*/[MODEL] x/' '[MODEL' 9 "'x' is unexpected" 'comments'
broken '/^\[MDI/d' FILE_TYPE 1 "'FILE_TYPE' comes before the first [SECTION]" '[UNITS]'
broken 's/^UNLOADED_RADIUS.*/UNLOADED_RADIUS = 0/' UNLOADED_RADIUS 19 'must be greater than zero, not 0' 'positive'
broken 's/^VERTICAL_STIFFNESS.*/VERTICAL_STIFFNESS = -1/' VERTICAL_STIFFNESS 22 'must be greater than zero' 'positive'
broken 's/^VERTICAL_DAMPING.*/VERTICAL_DAMPING = -1/' VERTICAL_DAMPING 20 'must not be negative' 'positive'
broken 's/^PKY2.*/PKY2 = 0/' PKY2 8 "PKY2 of tire 'all' must not be zero" 'USE_MODE'
broken 's/^LMUX.*/LMUX = 0/' LMUX 8 "LMUX of tire 'all' must be greater than zero" 'positive'
broken 's/^KPUMIN.*/KPUMIN = 0.1/' KPUMIN 10 'must not be above zero' 'negative'
broken 's/^CAMMAX.*/CAMMAX = -0.1/' CAMMAX 10 'must not be below zero' 'positive'
broken 's/^QSY1.*/QSY3 = 0.01/; /^LONGVL/d' '[MODEL]' 1 '[MODEL] lacks LONGVL' 'LONGVL'
broken '/^PTY2/d' PTY1 8 'PTY1' 'PTY2'
broken 's/^VERTICAL_DAMPING.*/BOTTOM_STIFF = 1e6/; /^RIM_RADIUS/d' '[DIMENSION]' 1 '[DIMENSION] lacks RIM_RADIUS' 'RIM_RADIUS'
broken 's/^VERTICAL_DAMPING.*/BOTTOM_STIFF = 1e6/; s/^RIM_RADIUS.*/RIM_RADIUS = 1/' BOTTOM_STIFF 16 'the rim touches' 'RIM_RADIUS'

# bytes that are no text, and lines that are too long for anybody
printf '[UNITS]\nLENGTH\000 = 1\n' >t.tir
refused 'LENGTH' 7 'this is no text: byte 0' '.tir file'
: >t.tir
"$gicgen" --dump-model cart.veh >dump 2>err
[ $? -eq 1 ] && grep -q "t.tir:1:1: error: .*\[MODEL\]" err
verdict $? "an empty file: $(cat err)"
long=$(head -c 10000 /dev/zero | tr '\0' 9)
sed "s/^PCX1 = .*/PCX1 = $long/" "$good" >t.tir
refused 'PCX1' 8 "PCX1 of tire 'all': 999" '1.8e308' 'a number of 10 kB'
sed "s/^PCX1 = .*/K$long/" "$good" >t.tir
refused 'K999' 1 'neither a [SECTION] nor KEY = value' 'KEY = value' 'a key of 10 kB'
sed "s/^PCX1 = .*/&\nK$long = 1/" "$good" >t.tir
# shellcheck disable=SC2022  # any number of 9
"$gicgen" --dump-model cart.veh >dump 2>err && cmp -s dump plain && grep -q "'K999*' is not known" err
verdict $? 'an unknown key of 10 kB'

# ---- anything -------------------------------------------------------------------------------------------------------

/usr/bin/python3 "$root/tests/tools/tir.py" fuzz "$good" 300 "$gicgen" cart.veh t.tir >said 2>&1
verdict $? "fuzz: $(tail -n 3 said)"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
