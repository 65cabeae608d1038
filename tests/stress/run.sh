#!/bin/sh
# SPDX-License-Identifier: MIT
# run.sh [ATTACK...]: tries to break what was built, with every attack or with those named, and writes what was tried
# and what happened into $BUILD/stress/table.md. The last line is `N rows, N findings`; the exit status is 0 when there
# are no findings.
#
# An attack is a script tests/stress/NAME.sh. Its first line of comment is its title and names the programs that it wants
# as arguments, as those of tests do (tests/paths.sh). STRESS says how much it is to try: `short`, some seconds, for
# the tests, or `full`, the default. It prints one line for each model or reader it attacked:
#
#     attack | model or reader | tried | OK | refused | worst | verdict
#
# with the numbers of tries, of those that ended well and of those that ended in a status or a message; the worst thing
# seen, in words or as a number with its unit; and `ok`, perhaps followed by a remark (`ok: ...`), or whatever is wrong.
# A finding is any other verdict, a row whose tries are not all accounted for, one that names no number but `nan`, an
# attack without rows, with an exit status, or one that takes longer than LIMIT seconds (short: 600, full: 7200). What an
# attack prints on standard error ends in $BUILD/stress/NAME.log. ATTACKS is another folder of attacks.
cd "$(dirname "$0")/../.." || exit 1
build=${BUILD:-build}
attacks=${ATTACKS:-tests/stress}
STRESS=${STRESS:-full}
. tests/paths.sh
case $STRESS in
short) limit=${LIMIT:-600} ;;
full) limit=${LIMIT:-7200} ;;
*) echo "STRESS is 'short' or 'full', not '$STRESS'" >&2 && exit 2 ;;
esac
mkdir -p "$build/stress" || exit 1
GICGEN_CACHE=$(mktemp -d) || exit 1
export GICGEN_CACHE STRESS
trap 'rm -rf "$GICGEN_CACHE"' EXIT
trap 'exit 130' INT TERM

table=$build/stress/table.md
{
    echo "# Attacks ($STRESS)"
    echo
    echo "$(uname -srm), $(${CC:-cc} --version | head -n 1)"
    echo
    echo "| attack | model or reader | tried | OK | refused | worst | verdict |"
    echo "|---|---|---|---|---|---|---|"
} >"$table" || exit 1

# Rows of an attack as they come: into the table, in columns for who watches, with a verdict of our own where a row can't
# stand as it is. exit status 1: findings, 2: no rows.
judge() {
    rows=0
    found=0
    while IFS= read -r line; do
        rows=$((rows + 1))
        printf '%s\n' "$line" | judge_row || found=1
    done
    [ $rows -gt 0 ] || return 2
    return $found
}

judge_row() {
    awk -F ' *[|] *' -v table="$table" '
        {
            columns = NF
            row = $0
            gsub(/[|]/, "/", row)
            verdict = $7
            if (columns != 7)
                verdict = "a row of " columns " columns: " row
            else if ($3 !~ /^[0-9]+$/ || $4 !~ /^[0-9]+$/ || $5 !~ /^[0-9]+$/)
                verdict = "counts that are none: " $7
            else if (verdict ~ /^ok/ && ($3 == 0 || $3 != $4 + $5))
                verdict = "lost: tried " $3 ", accounted for " $4 + $5
            else if (verdict ~ /^ok/ && tolower($6) ~ /(^|[^a-z])-?(nan|inf)([^a-z]|$)/)
                verdict = "not a number: " $6
            found = verdict !~ /^ok(:|$)/
            printf "| %s | %s | %s | %s | %s | %s | %s |\n", $1, $2, $3, $4, $5, $6, verdict >>table
            printf "  %-14s %-24s %9s tried %9s OK %9s refused  %-34s %s\n", $1, $2, $3, $4, $5, $6, verdict
        }
        END { exit found }'
}

# finding ATTACK TEXT: what the frame saw itself
finding() {
    echo "| $1 | | | | | | $2 |" >>"$table"
    echo "  $1: $2"
}

if [ $# -eq 0 ]; then
    for script in "$attacks"/*.sh; do
        name=$(basename "$script" .sh)
        [ "$name" = run ] || set -- "$@" "$name"
    done
fi
at=0
for name in "$@"; do
    script=$attacks/$name.sh
    log=$build/stress/$name.log
    at=$((at + 1))
    echo "[$at/$#] $(sed -n "s/^# $name\.sh[A-Z0-9_ ]*: //p" "$script")"
    start=$(date +%s)
    # shellcheck disable=SC2046  # one argument a path
    { timeout -k 10 "$limit" sh "$script" $(paths "$script") 2>"$log"; echo $? >"$log.status"; } | judge
    judged=$?
    status=$(cat "$log.status" && rm -f "$log.status")
    case $status in
    0) [ $judged -ne 2 ] || finding "$name" "no rows" ;;
    124 | 137) finding "$name" "takes longer than $limit s" ;;
    *) [ $judged -eq 1 ] || finding "$name" "exit status $status: $(tail -n 2 "$log" | tr '|\n' '/ ')" ;;
    esac
    echo "  $(($(date +%s) - start)) s"
done
rows=$(grep -c '^| ' "$table")
findings=$(grep '^| ' "$table" | grep -cv '| ok\(: [^|]*\)* |$')
echo "$((rows - 1)) rows, $((findings - 1)) findings: $table"
[ "$findings" -eq 1 ]
