#!/bin/sh
# SPDX-License-Identifier: MIT
# test_mutants.sh: mutants.py on a project of a few lines: what a test notices, what hangs, what compiles to the same and
# what nothing notices are told apart; a run that was stopped goes on; every kind of change is found in code, none in
# comments, texts and declarations.
root=$(cd "$(dirname "$0")/../.." && pwd)
# shellcheck source=tests/lib/checking.sh
. "$(dirname "$0")/../lib/checking.sh"
project=$work/project
mkdir -p "$project/generator" "$project/runtime" "$project/templates" "$project/models" "$project/tests/system" "$project/tests/lib"
cp "$root/tests/lib/checking.sh" "$project/tests/lib"
cp "$root/tests/paths.sh" "$project/tests"

cat >"$project/generator/sums.c" <<'XXX'
/* 3 * x in a comment, and "4 + 5" */
int triple(int x);
int nothing(int x);
int unused(int x);
int back(int x);
int triple(int x)
{
    return 3 * x;
}
int nothing(int x)
{
    (void)(x + 5);
    return x;
}
int unused(int x)
{
    return x - 7;
}
int back(int x)
{
    return -x;
}
XXX
cat >"$project/generator/gicgen.c" <<'XXX'
int triple(int x);
int nothing(int x);
int back(int x);
int main(int arguments, char **argument)
{
    (void)argument;
    while (back(-1) != 1)
        continue;
    return triple(nothing(arguments + 1)) == 6 ? 0 : 1;
}
XXX
cat >"$project/Makefile" <<'XXX'
build/gicgen: build/generator/gicgen.o build/generator/sums.o
	$(CC) $(CFLAGS) -o $@ $^
build/%.o: %.c
	@mkdir -p $(@D)
	$(CC) $(CFLAGS) -Wall $(WERROR) -c -o $@ $<
XXX
cat >"$project/tests/system/test_sums.sh" <<'XXX'
#!/bin/sh
# test_sums.sh GICGEN: sums
. "$(dirname "$0")/../lib/checking.sh"
check "triple" "$1"
echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
XXX
echo 'generator/*: test_sums' >"$work/tests.txt"
mutants() {
    python3 "$root/tests/mutants.py" --root "$project" --scratch "$work/scratch" --tests "$work/tests.txt" \
        --journal "$work/journal.txt" --only 'generator/sums.c' --grace 1 "$@" >"$work/out" 2>"$work/err"
}
verdict_of() { awk -F'\t' -v line="$1" '$3 == line { print $6 }' "$work/journal.txt"; }

# how long the test takes is known from an earlier run
mkdir "$work/scratch" && echo 'test_sums 0.1' >"$work/scratch/usual"
mutants --count 1
check "one change" [ $? -eq 0 ]
check "and no more" [ "$(grep -c 'noticed\|SURVIVED' "$work/journal.txt")" -eq 1 ]
cp "$work/journal.txt" "$work/first.txt"
mutants --count 10
check "it goes on" [ "$(sed 1d "$work/first.txt" | grep -cxFf - "$work/journal.txt")" -eq "$(sed 1d "$work/first.txt" | wc -l)" ]
check "all lines with code: $(cut -f3 "$work/journal.txt" | tr '\n' ' ')" [ "$(sed 1d "$work/journal.txt" | cut -f3 | sort -n | tr '\n' ' ')" = "8 12 17 21 " ]
check "a test notices ($(verdict_of 8))" [ "$(verdict_of 8)" = noticed ]
check "what compiles to the same is drawn again ($(verdict_of 12))" [ "$(verdict_of 12)" = equivalent ]
check "what nothing notices survives ($(verdict_of 17))" [ "$(verdict_of 17)" = SURVIVED ]
check "what hangs is noticed ($(verdict_of 21))" [ "$(verdict_of 21)" = "noticed (hang)" ]
check "totals" prints '^3 changes, 2 noticed (66.7 %), 1 survived, 0 still open.* 1 equivalent, 0 refused'
check "the copy is as before" cmp -s "$project/generator/sums.c" "$work/scratch/generator/sums.c"
mutants --table
check "a table" prints '^| [0-9a-f]* | generator/sums.c:17 | .* | `return x - 7;` | \*\*nothing\*\* |$'

# kinds of changes
cat >"$work/kinds.c" <<'XXX'
enum { SIZE = 3 };
int f(const double a[3], double x, int i, int j)
{
    const double low = 1e-9, high = 0.5;
    /* i + j */
    if (i < j && !isnan(x))
        puts("1 + 2");
    x += sin(fabs(a[i])) - low;
    free(x);
    return x > high ? -1 : i++;
}
XXX
python3 - "$root/tests/mutants" "$work/kinds.c" >"$work/out" 2>"$work/err" <<'XXX'
import sys
sys.path.insert(0, sys.argv[1])
import sites
for line, all in sites.sites_of(open(sys.argv[2]).read()).items():
    for site in all:
        print(line, site.what)
XXX
for kind in "4 1e-9 is 1e-06" "4 0.5 is 1.0" "6 condition negated" "6 '<' is '<='" "6 '&&' is '||'" "6 '!' dropped" "6 i is j" \
    "8 '+=' is '-='" "8 sin is cos" "8 fabs() dropped" "8 '-' is '+'" "8 index i is i + 1" "8 statement removed" "8 low is high" \
    "10 '>' is '>='" "10 sign dropped" "10 1 is 0" "10 '++' is '--'"; do
    check "$kind" grep -qxF -- "$kind" "$work/out"
done
check "not in declarations, comments, texts, or where memory is given back" eval '! grep -q "^[12357] \|^9 statement" "$work/out"'

echo "$passed passed, $failed failed"
[ "$failed" -eq 0 ]
