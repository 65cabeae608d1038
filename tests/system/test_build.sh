#!/bin/sh
# SPDX-License-Identifier: MIT
# test_build.sh GICRUN: engine cc and the objects that it keeps: a compiler starts where it must and only there, nothing
# stale or half-written is ever run, and a run ends well without a place to keep anything. Results are compared with
# those of the engine tape, which has no compiler and agrees digit by digit.
gicrun=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
mounted=
trap '[ -z "$mounted" ] || umount "$work/full"; rm -rf "$work"' EXIT
GICGEN_CACHE=$work/kept
TMPDIR=$work/tmp
export GICGEN_CACHE TMPDIR
unset GICGEN_CACHE_SIZE
mkdir "$TMPDIR" "$work/bin"

# a compiler that counts its starts
cat >"$work/bin/counting" <<END
#!/bin/sh
echo start >>"$work/starts"
exec cc "\$@"
END
chmod +x "$work/bin/counting"

# run ARGUMENT...: gicrun with the counting compiler, its results in $work/out, messages in $work/err, exit status in
# $status and the number of compilers it started in $starts
run() {
    : >"$work/starts"
    "$gicrun" --general --engine cc --cc "$work/bin/counting" \
        "$work/mass.veh" "$work/mass.scene" "$@" >"$work/out" 2>"$work/err"
    status=$?
    starts=$(wc -l <"$work/starts")
}
# good STARTS: the run ended well, started so many compilers and left nothing in TMPDIR
good() {
    [ "$status" -eq 0 ] && [ "$starts" -eq "$1" ] && cmp -s "$work/out" "$work/right" && [ -z "$(ls -A "$TMPDIR")" ]
}
objects() { find "$GICGEN_CACHE" -name '*.so' | wc -l; }
files() { find "$GICGEN_CACHE" -type f | wc -l; }
notes() { grep -c '^gicrun: note: ' "$work/err"; }

cat >"$work/mass.veh" <<'END'
gicgen: 1
model: mass
gravity: [0, 0, 0]
base: ground
bodies:
  cart: {mass: 2, com: [0, 0, 0], inertia: [1, 1, 1]}
joints:
  rail: {type: prismatic, bodies: [ground, cart], axis: [1, 0, 0]}
coordinates:
  x: {type: translation, bodies: [ground, cart], axis: [1, 0, 0], range: [-9, 9]}
forces:
  spring: {type: spring_damper, coordinate: x, stiffness: 72}
outputs:
  x: {type: coordinate, coordinate: x}
END
cat >"$work/mass.scene" <<'END'
gicscene: 1
duration: 0.5
step: 0.005
initial: {coordinates: {x: 0.1}}
END
# the right results of the model as it is now
right() { "$gicrun" -q --engine tape "$work/mass.veh" "$work/mass.scene" -o "$work/right" 2>"$work/err"; }
right

# ---- kept and found ----------------------------------------------------------------------------------------

run
check 'the first run compiles' good 1
run
check 'the second run starts no compiler' good 0
check 'it has nothing to note' [ "$(notes)" -eq 0 ]
run --cflags '-O1 -g'
check 'other options compile' good 1
run --cflags '-O1 -g'
check 'and are found again' good 0
run --solve augmented --cflags -O0
check 'another form of the equations compiles' [ "$starts" -eq 1 ]
run --cflags -fno-such-option
check 'an option that the compiler refuses is an error' [ "$status" -eq 1 ]
check 'with its message and a remedy' grep -q 'no-such-option' "$work/err"
run --cflags -DGIC_FLOAT
check 'options that change the number type are noticed' grep -q 'error: the compiled model does not fit' "$work/err"
check 'objects that do not fit are not kept' [ "$(objects)" -eq 3 ]

sed 's/stiffness: 72/stiffness: 73/' "$work/mass.veh" >"$work/changed" && mv "$work/changed" "$work/mass.veh"
right
run
check 'a changed model compiles' good 1
run
check 'and is found again' good 0

# ---- stale -------------------------------------------------------------------------------------------------

echo '# a later version' >>"$work/bin/counting"
run
check 'another compiler of the same name compiles' good 1
run
check 'and its object is found again' good 0
echo '#define OF_NO_USE 1' >"$work/extra.h"
run --cflags "-include $work/extra.h"
run --cflags "-include $work/extra.h"
check 'a file among the options: found again' good 0
echo '#define OF_NO_USE 22' >"$work/extra.h"
run --cflags "-include $work/extra.h"
check 'a changed file among the options compiles' good 1
mkdir "$work/other"
cp "$work/bin/counting" "$work/other/"
: >"$work/starts"
for folder in other bin; do
    PATH=$work/$folder:$PATH "$gicrun" -q --general --engine cc --cc counting \
        "$work/mass.veh" "$work/mass.scene" >"$work/out" 2>"$work/err"
done
check 'the compiler is the one that PATH finds' [ "$(wc -l <"$work/starts")" -eq 2 ]
CPATH=$work run
check 'other folders of headers compile' good 1

# ---- damaged -----------------------------------------------------------------------------------------------

# every kept object, so that the one in question is among them
damage() {
    for object in "$GICGEN_CACHE"/*.so; do
        "$@" "$object"
    done
}
run
damage truncate -s 4096
run
check 'truncated objects are compiled anew' good 1
run
check 'and repaired by that' good 0
damage truncate -s 0
run
check 'empty objects are compiled anew' good 1
flip() { printf 'XXXX' | dd of="$1" bs=1 seek=5000 conv=notrunc 2>"$work/dd"; }
damage flip
run
check 'damaged objects are compiled anew' good 1
# whole, but of another model
rm -f "$GICGEN_CACHE"/*.so
sed 's/^model: mass/model: other/' "$work/mass.veh" >"$work/other.veh"
"$gicrun" -q --general --engine cc "$work/other.veh" "$work/mass.scene" >"$work/out" 2>"$work/err"
mv "$GICGEN_CACHE"/*.so "$work/other.so"
run
damage cp "$work/other.so"
run
check 'an object that does not fit is compiled anew' good 1
run
check 'and repaired by that' good 0
cat >"$work/bin/breaking" <<'END'
#!/bin/sh
cc "$@"
for word; do
    case $word in */model.so) printf 'not an object' >"$word" ;; esac
done
END
chmod +x "$work/bin/breaking"
"$gicrun" --general --engine cc --cc "$work/bin/breaking" "$work/mass.veh" "$work/mass.scene" >"$work/out" 2>"$work/err"
check 'an object that cannot be loaded is an error' [ $? -eq 1 ]
check 'and is not kept' [ "$(objects)" -eq 1 ]

# ---- several at once, and killed ones ----------------------------------------------------------------------

: >"$work/starts"
for i in 1 2 3 4; do
    "$gicrun" -q --general --engine cc --cc "$work/bin/counting" \
        "$work/mass.veh" "$work/mass.scene" >"$work/out$i" 2>>"$work/err" &
done
wait
for i in 1 2 3 4; do
    check "run $i of four at once is right" cmp -s "$work/out$i" "$work/right"
done
check 'they keep one object' [ "$(objects)" -eq 1 ]
check 'and nothing half-written' [ "$(files)" -eq 1 ]
run
check 'which the next run finds' good 0

rm -f "$GICGEN_CACHE"/*
cat >"$work/bin/killing" <<'END'
#!/bin/sh
cc "$@"
kill -KILL $PPID
END
chmod +x "$work/bin/killing"
"$gicrun" --general --engine cc --cc "$work/bin/killing" "$work/mass.veh" "$work/mass.scene" >"$work/out" 2>"$work/err"
check 'a run killed when its object is there keeps nothing' [ "$(objects)" -eq 0 ]
rm -rf "${TMPDIR:?}"/*
# what one killed while it kept its object leaves
head -c 5000 "$gicrun" >"$GICGEN_CACHE/0123456789abcdef0123456789abcdef.so.Xa3b5c"
touch -d '2 hours ago' "$GICGEN_CACHE/0123456789abcdef0123456789abcdef.so.Xa3b5c"
run
check 'the next run compiles' good 1
check 'what killed runs left goes in time' [ "$(files)" -eq 1 ]

# ---- no place to keep anything -----------------------------------------------------------------------------

GICGEN_CACHE='' run
check 'an empty GICGEN_CACHE keeps nothing' good 1
check 'and is silent about it' [ "$(notes)" -eq 0 ]
GICGEN_CACHE_SIZE=0 run --cflags -O0
GICGEN_CACHE_SIZE=0 run --cflags -O0
check 'a cache of no size keeps nothing' good 1
check 'and drops what was there' [ "$(objects)" -eq 0 ]

# nowhere REASON: a run that can keep nothing ends well with one line of note, none when it should be quiet
nowhere() {
    run
    check "$1: the run goes on" good 1
    check "$1: one line of note" [ "$(notes)" -eq 1 ]
    run -q
    check "$1: no note when quiet" [ ! -s "$work/err" ]
    check "$1: quiet, it goes on" good 1
}
GICGEN_CACHE=/proc/nowhere
nowhere 'a folder that cannot be made'
GICGEN_CACHE=$work/mass.veh
nowhere 'a file in place of the folder'
GICGEN_CACHE=$work/everybodys
mkdir -m 0777 "$GICGEN_CACHE"
chmod 0777 "$GICGEN_CACHE"
nowhere 'a folder in which everybody may write'
mkdir "$work/full"
if mount -t tmpfs -o size=16k,mode=700 none "$work/full" 2>"$work/err"; then
    mounted=yes
    GICGEN_CACHE=$work/full
    nowhere 'a full file system'
    check 'a full file system: nothing half-written stays' [ -z "$(ls -A "$work/full")" ]
else
    echo "no full file system tried, for this user can't mount one"
fi
if [ "$(id -u)" -ne 0 ]; then # root may write anyway
    GICGEN_CACHE=$work/forbidden
    mkdir -m 0500 "$GICGEN_CACHE"
    nowhere 'a folder without the right to write'
fi

# ---- engines without a compiler touch none of it -----------------------------------------------------------

GICGEN_CACHE=$work/untouched
run --engine tape
check 'the engine tape starts no compiler and keeps nothing' [ "$starts" -eq 0 ] && [ ! -e "$GICGEN_CACHE" ]

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
