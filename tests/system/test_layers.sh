#!/bin/sh
# SPDX-License-Identifier: MIT
# test_layers.sh GICRUN GICSWEEP GICBENCH: folders use those below them in tests/layers.txt alone, by what files include and
# by what objects call; and layers.sh sees it where one does not. The programs are arguments so that all objects are there.
gicrun=$1
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
build=$(cd "$(dirname "$gicrun")" && pwd)
layers=$root/tests/lib/layers.sh

# a copy of the sources, and objects by reference: layers.sh leaves nothing in either
mkdir "$work/root" "$work/objects"
cp -r "$root/generator" "$root/runtime" "$work/root/"
cp -rs "$build/generator" "$build/runtime" "$work/objects/"
layers() { sh "$layers" "$work/root" "$work/objects" >"$work/out" 2>"$work/err"; }
silent() { [ ! -s "$work/out" ] && [ ! -s "$work/err" ]; }
# alone TEXT: this is all that is said
alone() { [ "$(wc -l <"$work/out")" -eq 1 ] && grep -qF -- "$1" "$work/out" && [ ! -s "$work/err" ]; }

layers
check "folders use those below them" silent

# each mistake is planted, seen, and taken back
plant() { cp "$work/root/$1" "$work/kept" && printf '%s\n' "$2" >>"$work/root/$1"; }
take_back() { cp "$work/kept" "$work/root/$1"; }

plant generator/base/memory.c '#include "model/model.h"'
layers
check "an upward include of a source" alone "includes model/model.h, of a folder that stands on this one"
take_back generator/base/memory.c

plant generator/vehicle/vehicle.h '#include "scene/scene.h"'
layers
check "an upward include of a header, from generator to runtime" alone "generator/vehicle/vehicle.h:"
take_back generator/vehicle/vehicle.h

plant runtime/run/simulate.c '#include "subset/subset_private.h"'
layers
check "a private header of another folder" alone "private to its folder"
take_back runtime/run/simulate.c

plant runtime/gicrun/gicrun.c '#include "model/model.h"'
layers
check "a program that passes the library by" alone "runtime/gicrun/gicrun.c:"
take_back runtime/gicrun/gicrun.c

plant runtime/run/simulate.c '#include "../scene/scene.h"'
layers
check "an include by another path" alone "write folder/name.h"
take_back runtime/run/simulate.c

# compile TEXT: generator/base/planted.c and its object
compile() {
    printf '%s\n' "$1" >"$work/root/generator/base/planted.c"
    ${CC:-cc} -c -o "$work/objects/generator/base/planted.o" "$work/root/generator/base/planted.c"
}

compile 'void formulate(void); void planted_call(void); void planted_call(void) { formulate(); }'
layers
check "an upward call" alone "generator/base/planted.c: uses formulate of generator/vehicle/formulation.c"
compile 'extern const char *const engine_name[]; const char *planted_use(void); const char *planted_use(void) { return engine_name[0]; }'
layers
check "an upward use of data" alone "uses engine_name of runtime/run/engines.c"
rm "$work/root/generator/base/planted.c" "$work/objects/generator/base/planted.o"

mkdir "$work/root/runtime/attic"
echo 'typedef int attic;' >"$work/root/runtime/attic/attic.h"
layers
check "a folder that is not in the list" alone "runtime/attic/: no line in tests/layers.txt"
rm -r "$work/root/runtime/attic"

layers
check "with all of them taken back" silent

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
