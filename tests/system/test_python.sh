#!/bin/sh
# SPDX-License-Identifier: MIT
# test_python.sh GICRUN: the Python package (runtime/python) on Debian's Python: its calls, its examples, a step of
# a batch against C, and pip without a network.
build=$(cd "$(dirname "$1")" && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
root=$(cd "$(dirname "$0")/../.." && pwd)
ln -s "$root/models" "$root/tests" "$work/"
cd "$work" || exit 1
GICGEN_LIBRARY=$build/libgic.so
PYTHONPATH=$root/runtime/python
export GICGEN_LIBRARY PYTHONPATH
python() { /usr/bin/python3 "$@" >"$work/out" 2>"$work/err"; }

check 'calls' python tests/python/calls.py
check 'all of them' grep -q '^OK$' "$work/err"
for example in "$root"/runtime/python/examples/*.py; do
    check "$(basename "$example")" python "$example"
    check 'it says something' [ -s "$work/out" ]
done
check 'there are five' [ "$(find "$root/runtime/python/examples" -name '*.py' | wc -l)" -eq 5 ]

# piece LANGUAGE PAGE: what stands between fences of that language on a page
piece() { sed -n "/^\`\`\`$1\$/,/^\`\`\`\$/p" "$root/$2" | sed '/^```/d'; }
piece python runtime/PYTHON.md >page.py
check 'the piece on its page' sh -c 'grep -q import page.py && /usr/bin/python3 page.py >"$1" 2>&1' sh "$work/err"
piece c runtime/README.md >page.c
check 'the program on the page of the library' cc -std=c99 -Wall -Wextra -Werror -I"$root/runtime/host" -o page page.c "$GICGEN_LIBRARY"
ln -s "$GICGEN_LIBRARY" libgic.so.1
check 'runs' sh -c 'LD_LIBRARY_PATH=. ./page | grep -q "^bounce after 0.2 s: [0-9.-]* m$"'

# the measurement of batches runs: what it measures is no test
cost() { sh "$root/tests/bench/python_batch.sh" "$GICGEN_LIBRARY" 1 >"$work/out" 2>"$work/err"; }
check 'the cost of a batch' cost
check 'of three' [ "$(grep -c ': 0\.[0-9]* 0\.[0-9]* [0-9.]*$' "$work/out")" -eq 3 ]

unset PYTHONPATH
without_network() { /usr/bin/python3 -m pip --version >/dev/null 2>&1 || return 0; /usr/bin/python3 -m pip install -q --no-index --no-deps --target "$work/site" "$root/runtime/python"; }
check 'pip install without a network' without_network
unset GICGEN_LIBRARY
[ ! -d "$work/site" ] || check 'what it installed works' env PYTHONPATH="$work/site" /usr/bin/python3 -c "
import gicgen
assert gicgen.__file__.startswith('$work/site')
gicgen.Model('models/pendulum.veh').instance().step(0.001)"
check 'the sources stay as they are' [ ! -e "$root/runtime/python/build" -a ! -e "$root/runtime/python/gicgen.egg-info" ]

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
