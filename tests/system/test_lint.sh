#!/bin/sh
# SPDX-License-Identifier: MIT
# test_lint.sh: sources are as clang-format writes them, and clang-tidy and shellcheck have nothing to say about them; and
# each of these notices what is wrong.
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
# target NAME [FOLDER]: make's, on the project or on a copy of parts of it
target() { make --no-print-directory -s -C "${2:-$root}" "$1" >"$work/said" 2>&1; }
refuses() { ! target "$1" "$work/copy" && grep -q "$2" "$work/said"; }
check 'sources have their format' target format-check
check 'nothing to say about C and scripts' target lint

mkdir -p "$work/copy/generator" "$work/copy/runtime" "$work/copy/tests" "$work/copy/.ci"
cp "$root/Makefile" "$root"/.clang-* "$root/.shellcheckrc" "$work/copy/"
printf '#!/bin/sh\ntrue\n' | tee "$work/copy/.ci/run" >"$work/copy/tests/good.sh"
printf 'int twice(int x)\n{\n    return 2 * x;\n}\n' >"$work/copy/generator/good.c"
check 'a small project is clean' target lint "$work/copy"
check 'and has its format' target format-check "$work/copy"
printf 'int twice(int x) { return 2*x; }\n' >"$work/copy/generator/loose.c"
check 'another format is refused' refuses format-check 'loose.c:1'
rm "$work/copy/generator/loose.c"
printf 'int twice(int x)\n{\n    return x == x ? 2 * x : 0;\n}\n' >"$work/copy/generator/odd.c"
check 'an odd expression is refused' refuses lint 'odd.c:3:.*misc-redundant-expression'
rm "$work/copy/generator/odd.c"
printf '#!/bin/sh\nrm -r $1/x\n' >"$work/copy/tests/odd.sh"
check 'a word without quotes is refused' refuses lint 'SC2086'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
