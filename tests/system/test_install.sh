#!/bin/sh
# SPDX-License-Identifier: MIT
# test_install.sh GICGEN GICRUN GICBENCH: what `make install` installs works from any folder and without the sources,
# pkg-config finds it, manuals name every option that -h names and no other, and `make uninstall` leaves nothing.
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
build=$(cd "$(dirname "$1")" && pwd)

# a prefix with a blank that is not the default, collected elsewhere as packagers do
prefix='/opt/vehicle dynamics'
made() {
    make --no-print-directory -s -C "$root" BUILD="$build" WERROR=-Werror DESTDIR="$work/stage" PREFIX="$prefix" "$@"
}
umask 077 # modes of what is installed must not depend on it
check 'make install' made install
there=$work/stage$prefix

# ---- files and modes ---------------------------------------------------------------------------------------

modes() { [ -z "$(find "$there" "$@")" ] || { find "$there" "$@" -printf '%m %p\n'; false; }; }
check 'folders may be read by all' modes -type d ! -perm 0755
check 'programs may be run by all' modes -path "$there/bin/*" ! -perm 0755
check 'other files may be read by all and run by none' modes -type f ! -path "$there/bin/*" ! -perm 0644
for file in bin/gicgen bin/gicrun bin/gicsweep bin/gicbench include/gic_runtime.h include/gic_road.h include/gic_road_lanes.h include/gic_gradient.h include/gic_batch.h include/gic_lanes.h include/gic_live.h \
    lib/libgic_runtime.a lib/gicgen/mumps.so lib/gicgen/hdf5.so lib/gicgen/bdf.so include/gic.h lib/libgic.a lib/libgic.so lib/libgic.so.1 lib/pkgconfig/gic.pc \
    lib/pkgconfig/gicgen.pc share/gicgen/gic_runtime.c share/gicgen/gic_road.c share/gicgen/gic_gradient.c share/gicgen/models/hmmwv.veh \
    share/gicgen/models/parts/chassis.veh share/gicgen/models/scenes/paper_run.scene \
    share/gicgen/models/roads/field_track.csv share/gicgen/models/tires/hmmwv_pac2002.tir \
    share/gicgen/models/FORMAT.md share/man/man1/gicgen.1 share/man/man1/gicrun.1 \
    share/man/man1/gicsweep.1 share/man/man1/gicbench.1; do
    check "$file is there" [ -s "$there/$file" ]
done
models() { find "$1/models" -type f | wc -l; }
check 'all models are there' [ "$(models "$there/share/gicgen")" -eq "$(models "$root")" ]
check 'nothing speaks of the place of collection, and nothing is left to fill in' \
    sh -c "! grep -rIl -e '$work' -e '@PREFIX@' -e '@VERSION@' \"$there\""

# ---- manuals -----------------------------------------------------------------------------------------------

# options PATTERN: all words - or -- on standard input that look like options, each once
options() { grep -oE -- '(^|[^[:alnum:]-])--?[[:alpha:]][[:alnum:]-]*' | sed 's/^[^-]*//' | sort -u; }
for program in gicgen gicrun gicsweep gicbench; do
    page=$there/share/man/man1/$program.1
    "$there/bin/$program" -h | options >"$work/help"
    # .It Fl o , Fl -output Ar file
    sed -n 's/^\.It Fl //p' "$page" | sed 's/ , Fl /\n/g' | sed 's/ .*//; s/^/-/' | sort >"$work/page"
    check "$program has options" grep -q -- --version "$work/help"
    check "$program: the manual has the options of -h" diff "$work/help" "$work/page"
    for heading in NAME SYNOPSIS DESCRIPTION 'EXIT STATUS' FILES EXAMPLES; do
        check "$program: the manual has $heading" grep -q "^\.Sh $heading$" "$page"
    done
    "$there/bin/$program" -h | grep -oE '\$[A-Z_]+' | tr -d '$' | sort -u >"$work/variables"
    check "$program: the manual has the environment of -h" sh -c \
        "while read -r v; do grep -q \"^\.\(It \)\{0,1\}Ev \$v\" '$page' || exit 1; done <'$work/variables'"
    # style would ask for manuals of other packages too
    check "$program: mandoc finds nothing" mandoc -T lint -W warning "$page"
done

# ---- programs from another folder --------------------------------------------------------------------------

mkdir "$work/elsewhere"
cd "$work/elsewhere" || exit 1
PATH=$there/bin:$PATH
PKG_CONFIG_PATH=$there/lib/pkgconfig
export PATH PKG_CONFIG_PATH
# the files stand below DESTDIR here, unlike after a package's installation
config() { pkg-config --define-variable=prefix="$there" "$@" gicgen; }

check 'gicgen works' gicgen "$there/share/gicgen/models/hmmwv.veh" -o hmmwv.c
sed -n '/^```c$/,/^```$/p' "$root/README.md" | sed '/^```/d' >main.c
# with words as pkg-config quotes them
compile() { eval "cc $1 $(config --cflags) $2 $(config --libs) $3"; }
strict='-std=c99 -Wall -Wextra -Werror -O1'
check "README's example in double precision" compile "$strict" 'main.c hmmwv.c' '-o double'
check "README's example in single precision" compile "$strict -DGIC_FLOAT" 'main.c hmmwv.c' '-o single'
check "README's example with the runtime as source" eval "cc -std=c99 -O1 $(config --cflags) main.c hmmwv.c \
    '$(config --variable=runtime)' -lm -o source"
check 'the runtime in a shared object' compile '-shared -fPIC -O0' hmmwv.c '-Wl,-z,defs -o model.so'
# its chassis stands at 0.474 m
for program in double single source; do
    stands() { "./$program" | awk '/^ok: / { z = $6 } END { exit !(z > 0.473 && z < 0.475) }'; }
    check "the program $program runs" stands
done
version() { [ "gicgen $(pkg-config --modversion gicgen)" = "$(gicgen --version)" ]; }
check "pkg-config's version is gicgen's" version
# shellcheck disable=SC1003  # a backslash
recorded() { [ "$(pkg-config --variable=runtime gicgen | tr -d '\\')" = "$prefix/share/gicgen/gic_runtime.c" ]; }
check 'pkg-config names the installed place' recorded
check 'gicrun works' gicrun "$there/share/gicgen/models/pendulum.veh" \
    "$there/share/gicgen/models/scenes/pendulum.scene" -o run.csv
check 'its results are there' grep -q '^time' run.csv
check 'gicbench works' gicbench --version

# ---- the library -------------------------------------------------------------------------------------------

cat >library.c <<'C'
#include <gic.h>
#include <stdio.h>
int main(int count, char **word)
{
    gicl_library *lib = gicl_open();
    gicl_handle model, result;
    gicl_array columns;
    if (count < 3 || gicl_model_open(lib, word[1], 0, &model, 0) || gicl_run(lib, model, word[2], &result, 0) ||
        gicl_array_get(lib, result, 0, &columns, sizeof columns, 0))
        return 1;
    printf("%lld rows\n", (long long)columns.rows);
    return gicl_close(lib);
}
C
config_library() { pkg-config --define-variable=prefix="$there" "$@" gic; }
link_library() { eval "cc -std=c99 -Wall -Wextra -Werror -pedantic $(config_library --cflags) library.c $1 -o $2"; }
rows() { "$@" "$there/share/gicgen/models/pendulum.veh" "$there/share/gicgen/models/scenes/pendulum.scene" | grep -q '^[1-9][0-9]* rows$'; }
check 'a program with the shared library' link_library "$(config_library --libs)" shared_library
check 'runs' rows env LD_LIBRARY_PATH="$there/lib" ./shared_library
static_library=$(config_library --static --libs | sed 's/-lgic /-l:libgic.a /')
check 'a program with the static library' link_library "$static_library" static_library
check 'runs too' rows ./static_library
foreign() { nm -D --defined-only "$there/lib/libgic.so.1" | grep -v ' gicl_'; nm --defined-only "$there/lib/libgic.a" 2>/dev/null | grep ' [TDBRCVW] ' | grep -v ' gicl_'; }
check 'both show names of gic.h alone' [ -z "$(foreign)" ]
dist=$(echo "$there"/lib/python3*/dist-packages)
check 'Python finds package and library' env PYTHONPATH="$dist" PYTHONDONTWRITEBYTECODE=1 /usr/bin/python3 -c "
import gicgen
model = gicgen.Model('$there/share/gicgen/models/pendulum.veh')
assert len(model.run('$there/share/gicgen/models/scenes/pendulum.scene')) > 10"

# ---- the plug-in with MUMPS --------------------------------------------------------------------------------

shared=$there/share/gicgen/models
pendulum() { gicrun "$@" -q "$shared/pendulum.veh" "$shared/scenes/pendulum.scene" -o mumps.csv >"$work/out" 2>"$work/err"; }
check 'the programs themselves need no MUMPS' sh -c "! ldd '$there/bin/gicrun' | grep -i -e mumps -e fortran"
check 'gcp2 finds its plug-in' pendulum --engine gcp2
check 'its results are those of gcp1' sh -c "gicrun --engine gcp1 -q '$shared/pendulum.veh' '$shared/scenes/pendulum.scene' |
    paste -d, - mumps.csv | awk -F, 'NR > 1 { for (i = 1; i <= NF / 2; ++i) if ((\$i - \$(i + NF / 2))^2 > 1e-16) bad = 1 }
    END { exit bad || NR < 10 }'"
# names WHAT: the run failed and says so, with packages to install
names() { grep -q "engine gcp2 needs MUMPS: $1" "$work/err" && grep -q 'apt-get install libmumps-' "$work/err"; }
refused() { ! pendulum --engine gcp2 && [ ! -e mumps.csv ]; }
rm mumps.csv
mv "$there/lib/gicgen" "$work/aside"
check 'without the plug-in gcp2 is refused' refused
check 'the message names what to install' names 'it was not there'
check 'other engines run without it' pendulum --engine gcp1
rm mumps.csv
check 'the benchmark leaves gcp2 out' gicbench --rhs --quick "$shared/pendulum.veh" >"$work/said" 2>"$work/err"
check 'and says so' grep -q 'the engine gcp2 is left out.*apt-get install libmumps-' "$work/err"
check 'and has the other engines' sh -c "grep -q gcp1 '$work/said' && ! grep -q gcp2 '$work/said'"
mkdir "$there/lib/gicgen"
echo 'no library' >"$there/lib/gicgen/mumps.so"
check 'with a plug-in that is no library gcp2 is refused' refused
check 'the message says which' names '.*lib/gicgen/mumps.so'
rm -r "$there/lib/gicgen"
mv "$work/aside" "$there/lib/gicgen"

# ---- uninstall ---------------------------------------------------------------------------------------------

# what is foreign stays, in our folders too; what an earlier version left goes
: >"$there/bin/foreign"
: >"$there/share/gicgen/models/my own.veh"
: >"$there/share/gicgen/models/old.veh"
echo share/gicgen/models/old.veh >>"$there/share/gicgen/installed"
check 'make install over an older one' made install
check 'make uninstall' made uninstall
find "$work/stage" -type f | sort >"$work/left"
printf '%s\n' "$there/bin/foreign" "$there/share/gicgen/models/my own.veh" >"$work/wanted"
check 'only what is foreign stays' diff "$work/left" "$work/wanted"
check 'no folder of its own stays' [ ! -e "$there/lib/gicgen" -a ! -e "$there/share/gicgen/models/parts" ]
gone() { ! made uninstall >"$work/said" 2>&1 && grep -q 'gicgen is not installed in' "$work/said"; }
check 'a second time there is nothing to uninstall' gone

# ---- a home of one's own -----------------------------------------------------------------------------------

home="$work/my home"
mine() { make --no-print-directory -s -C "$root" BUILD="$build" WERROR=-Werror DESTDIR= "$@" >"$work/said" 2>&1; }
unset PKG_CONFIG_PATH
check 'make install in a place of its own' mine PREFIX="$home/.local" install
# what it says is what makes them found
grep '^[^:]*:  *export ' "$work/said" | sed 's/^[^:]*:  *//' >"$work/exports"
# shellcheck source=/dev/null
found() { (. "$work/exports" && [ "$(command -v gicgen)" = "$home/.local/bin/gicgen" ] && pkg-config --exists gicgen); }
check 'it says how programs and pkg-config are found' found
check 'only then' sh -c '! pkg-config --exists gicgen'
# shellcheck disable=SC1091
quiet() { . "$work/exports" && mine PREFIX="$home/.local" install && [ ! -s "$work/said" ]; }
check 'who is set up is told nothing' quiet
check 'make uninstall there' mine PREFIX="$home/.local" uninstall
check 'nothing is left there' [ -z "$(find "$home" -type f)" ]
relative() { ! mine PREFIX=local install && grep -q 'PREFIX is not a whole path: local' "$work/said" && [ ! -e "$root/local" ]; }
check 'a relative prefix is refused' relative

# ---- README's examples write into one folder ---------------------------------------------------------------

mkdir "$work/clone"
ln -s "$build" "$work/clone/build"
ln -s "$root/models" "$work/clone/models"
sed -n '/^    mkdir -p out/,/^$/p' "$root/README.md" | sed 's/:1000 /:4 /' >"$work/clone.sh"
check 'there are examples' [ "$(grep -c 'build/gic' "$work/clone.sh")" -ge 6 ]
examples() { (cd "$work/clone" && sh -e "$work/clone.sh") >"$work/said" 2>&1; }
check 'they work' examples
check 'and write into one folder alone' [ "$(cd "$work/clone" && echo *)" = 'build models out' ]
check 'which git ignores' grep -qx /out/ "$root/.gitignore"

# ---- an object that was compiled with a warning is no way around -Werror -----------------------------------

cat >"$work/warning" <<'XXX'
#!/bin/sh
case " $* " in *" -Werror "*) echo 'error: y [-Werror]' >&2; exit 1 ;; *' -c '*) echo 'warning: y' >&2 ;; esac
exec cc "$@"
XXX
chmod +x "$work/warning"
object() { make -s -C "$root" BUILD="$work/warned" CC="$work/warning" "$@" "$work/warned/generator/base/message.o" >"$work/said" 2>&1; }
check 'a warning is no error' object
check 'and is shown' grep -q 'warning: y' "$work/said"
check 'but it is one with -Werror, though the object is there' eval '! object WERROR=-Werror'

# ---- packages: tests/install.sh, demo.sh and run.sh before they install, with an apt-get that only writes down ----

mkdir "$work/apt"
tool() { cat >"$work/apt/$1" && chmod +x "$work/apt/$1"; }
printf '#!/bin/sh\nexit 1\n' | tool dpkg-query # nothing is installed
printf '#!/bin/sh\nexec "$@"\n' | tool sudo
tool apt-get <<XXX
#!/bin/sh
echo "\$*" >>"$work/calls"
case "\$*" in
*--assume-no*)
    echo '0 upgraded, 124 newly installed, 0 to remove and 0 not upgraded.'
    echo 'Need to get 1,091 kB/91.2 MB of archives.'
    echo 'After this operation, 1,342 MB of additional disk space will be used.'
    ;;
*) echo 'lines of apt-get' ;;
esac
XXX
packages() { PATH=$work/apt:$PATH BUILD=$work/log sh "$@" >"$work/out" 2>"$work/err"; }
size='They take 92 MB to fetch, 1342 MB on the disk, and about 3 min'
for script in install demo run; do
    rm -f "$work/calls"
    check "$script.sh --dry-run" packages "$root/tests/$script.sh" --dry-run
    check "$script.sh --dry-run says how much" grep -q "$size" "$work/out"
    check "$script.sh --dry-run says what" grep -q 'libtcc-dev' "$work/out"
    check "$script.sh --dry-run installs nothing" sh -c "! grep -v -e --assume-no -e Dir::State '$work/calls'"
    check "$script.sh --dry-run builds nothing" [ ! -e "$work/log" ]
done
rm -f "$work/calls"
check 'install.sh installs' packages "$root/tests/install.sh"
check 'it says how much before' grep -q "$size" "$work/err"
check 'by one command' [ "$(grep -c 'install -y' "$work/calls")" = 1 ]
check 'what the demonstration needs, and neither MPI nor Fortran' \
    sh -c "grep -q gnuplot-nox '$work/calls' && ! grep -qi -e mumps -e mpi -e fortran '$work/calls'"
check 'the lines of apt-get are in its log' grep -q 'lines of apt-get' "$work/log/install.log"
check 'and not on the screen' sh -c "! grep -q 'lines of apt-get' '$work/out' '$work/err'"
# the package of every header, so that a header that came along with something else is noticed
grep -rhE '^# *include <' --include='*.[ch]' "$root/generator" "$root/runtime" | grep -v -e dmumps_c -e windows.h -e '<hdf5.h>' -e '<gic.h>' -e IpStdCInterface -e '<cvode/' -e '<nvector/' -e '<sun' | sort -u >"$work/headers.c"
cc -std=c11 -D_POSIX_C_SOURCE=200809L -M "$work/headers.c" | grep -o '/usr/include/[^ ]*' >"$work/headers"
check 'there are headers of libraries' grep -q 'yaml\.h' "$work/headers"
xargs dpkg -S <"$work/headers" 2>&1 | sed 's/:.*//' | sort -u | grep -v '^linux-libc-dev$' >"$work/owners"
listed() { while read -r owner; do grep -q -w -e "$owner" "$work/calls" || { echo "not installed: $owner"; return 1; }; done <"$work/owners"; }
check 'the packages of all headers' listed
printf '#!/bin/sh\necho "E: no such package" && exit 100\n' | tool apt-get
check 'where it fails the script does' sh -c "! PATH='$work/apt:$PATH' BUILD='$work/log' sh '$root/tests/install.sh' >'$work/out' 2>'$work/err'"
check 'and shows why, and where the rest is' sh -c "grep -q 'E: no such package' '$work/err' && grep -q 'install.log' '$work/err'"

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
