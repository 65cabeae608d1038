#!/bin/sh
# SPDX-License-Identifier: MIT
# test_snippets.sh GICGEN GICRUN GICBENCH: commands, pieces of models, of scenes and of formulas that stand between back
# quotes on a page, or indented on a page of a format, work: tests/tools/snippets.py. A piece that a page shows without a row there
# is seen.
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
tests=$(cd "$(dirname "$0")/.." && pwd)

python3 "$tests/tools/snippets.py" "$@" >"$work/out" 2>"$work/err"
verdict $? 'snippets.py ends'
none_fails() { ! grep -A 12 '^FAILED' "$work/out" >"$work/failures"; }
check 'all pieces of all pages' none_fails
many() { [ "$(grep -c '^ok' "$work/out")" -gt 100 ]; }
check 'there are many' many
passed=$((passed + $(grep -c '^ok' "$work/out")))
cat "$work/failures"

# a page with pieces that are wrong, or unknown
mkdir "$work/root"
cp -r "$tests/../models" "$tests/../templates" "$tests/../README.md" "$tests/../Makefile" "$tests/../generator" "$tests/../runtime" "$work/root/"
mkdir "$work/root/tests" "$work/root/tests/system"
cp -r "$tests/bench" "$tests/tools" "$tests"/*.md "$tests"/*.py "$work/root/tests/"
cp "$tests/system/test_install.sh" "$work/root/tests/system/"
# shellcheck disable=SC2016  # back quotes of a page
printf '%s\n' 'Write `forces: {[a]: b}`, then `-k * nothing(strut)`. Call `gicgen --no-such-option`.' >>"$work/root/models/FORMAT.md"
sed -i 's/`sqrt(-1)`/`sqrt(1)`/; s/`min(1\/a, 5)`/`sqrt(-1)`/' "$work/root/models/FORMAT.md"
sed -i 's/"-x^2": place("force", FORMULA)/"-x^2": place("force", FORMULA, ("x", "y"))/' "$work/root/tests/tools/snippets.py"
python3 "$work/root/tests/tools/snippets.py" "$@" >"$work/out" 2>"$work/err"
sees() { grep -qF "FAILED $1" "$work/out"; }
# shellcheck disable=SC2016
check 'a piece without a row' sees 'models/FORMAT.md: `forces: {[a]: b}`'
# shellcheck disable=SC2016
check 'a formula without a row' sees 'models/FORMAT.md: `-k * nothing(strut)`'
# shellcheck disable=SC2016
check 'an option that there is not' sees 'models/FORMAT.md: `gicgen --no-such-option`'
# shellcheck disable=SC2016
check 'a name that the frame does not have' sees 'models/FORMAT.md: `-x^2`'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
