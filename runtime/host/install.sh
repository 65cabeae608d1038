#!/bin/sh
# SPDX-License-Identifier: MIT
# install.sh [--remove | FILE...]: what `make install` and `make uninstall` do, with their DESTDIR, PREFIX, BUILD, VERSION
# and PLUGINS (files or nothing) in the environment; FILE: manuals, by their ending .1, and models.
#
# share/gicgen/installed lists what was installed, and --remove goes by it: other files and their folders stay.
set -e
case $PREFIX in
/*) ;;
*)
    echo "make: error: PREFIX is not a whole path: $PREFIX" >&2
    echo "  remedy: begin it with /, as in PREFIX=\"$PWD/${PREFIX#./}\"" >&2
    exit 1
    ;;
esac
root=$DESTDIR$PREFIX
list=$root/share/gicgen/installed

if [ "$1" = --remove ]; then
    if [ ! -f "$list" ]; then
        echo "make: error: gicgen is not installed in $root: there is no $list" >&2
        echo "  remedy: give the PREFIX that \`make install\` was given" >&2
        exit 1
    fi
    while IFS= read -r file; do rm -f "$root/$file"; done <"$list"
    rm -rf "$root"/lib/python3*/dist-packages/gicgen/__pycache__
    rm -f "$list"
    for folder in "$root/share/gicgen" "$root/lib/gicgen" "$root"/lib/python3*/dist-packages/gicgen; do
        [ ! -d "$folder" ] || find "$folder" -depth -type d -exec rmdir {} + 2>/dev/null || true
    done
    exit 0
fi

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# put MODE FILE FOLDER: into a folder of the prefix
put() {
    install -d "$root/$3"
    install -m "$1" "$2" "$root/$3"
    echo "$3/${2##*/}" >>"$work/list"
}

# place FILE FOLDER: a text that names places, which are filled in
place() {
    sed "s|@PREFIX@|$(printf '%s' "$PREFIX" | sed 's/[&|\\]/\\&/g')|g; s|@VERSION@|$VERSION|g" "$1" >"$work/${1##*/}"
    put 644 "$work/${1##*/}" "$2"
}

umask 022
for program in gicgen gicrun gicsweep gicbench; do put 755 "$BUILD/$program" bin; done
for header in gic_runtime gic_road gic_road_lanes gic_gradient gic_batch gic_lanes gic_live; do put 644 runtime/$header.h include; done
put 644 "$BUILD/install/libgic_runtime.a" lib
# the library for programs and for Python, whose package finds it from where it is
put 644 runtime/host/gic.h include
put 644 "$BUILD/libgic.a" lib
cp "$BUILD/libgic.so" "$work/libgic.so.1"
put 644 "$work/libgic.so.1" lib
ln -sf libgic.so.1 "$root/lib/libgic.so"
echo lib/libgic.so >>"$work/list"
# Debian's Python looks there
python=$([ -x /usr/bin/python3 ] && echo /usr/bin/python3 || echo python3)
packages=lib/$([ "$PREFIX" = /usr ] && echo python3 ||
    "$python" -c 'import sys; print("python3.%d" % sys.version_info[1])' 2>/dev/null || echo python3)/dist-packages
for file in runtime/python/gicgen/*.py; do put 644 "$file" "$packages/gicgen"; done
for file in $PLUGINS; do put 644 "$file" lib/gicgen; done
put 644 runtime/gic_runtime.c share/gicgen
put 644 runtime/gic_road.c share/gicgen
put 644 runtime/gic_gradient.c share/gicgen
for file; do
    case $file in
    *.1) place "$file" share/man/man1 ;;
    *) put 644 "$file" "share/gicgen/$(dirname "$file")" ;;
    esac
done
mkdir "$work/pc"
for name in generator/gicgen runtime/library/gic; do
    cp "$name.pc.in" "$work/pc/${name##*/}.pc"
    place "$work/pc/${name##*/}.pc" lib/pkgconfig
done
# of an earlier version too, so that uninstalling leaves nothing of it
if [ -f "$list" ]; then cat "$list" >>"$work/list"; fi
sort -u "$work/list" >"$work/installed"
install -m 644 "$work/installed" "$list"

# a package's files are not used where they are collected
[ -z "$DESTDIR" ] || exit 0
# among PATH FOLDER
among() { case ":$1:" in *":$2:"*) ;; *) false ;; esac; }
among "$PATH" "$PREFIX/bin" ||
    echo "The shell finds gicgen with:  export PATH=\"$PREFIX/bin:\$PATH\""
known=$PKG_CONFIG_PATH:$(pkg-config --variable pc_path pkg-config 2>/dev/null || echo /usr/local/lib/pkgconfig)
among "$known" "$PREFIX/lib/pkgconfig" ||
    echo "pkg-config finds it with:     export PKG_CONFIG_PATH=\"$PREFIX/lib/pkgconfig:\$PKG_CONFIG_PATH\""
"$python" -c "import sys; sys.exit('$PREFIX/$packages' not in sys.path)" 2>/dev/null ||
    echo "Python finds it with:         export PYTHONPATH=\"$PREFIX/$packages:\$PYTHONPATH\""
