#!/usr/bin/env bash
# ./test.sh [--all] [ctest options]: installs what is missing, builds everything, runs the tests. Tests labelled `slow`
# run only with --all. The last line is "N passed, N failed".
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
me=test.sh
. "$top/.ci/setup.sh"

selection=(-LE '^slow$')
if [ "${1:-}" = --all ]; then
    selection=()
    shift
fi
directory=$top/build
trap 'give_back "$top/build"' EXIT
install_missing "$top/.ci/packages" "$top/.ci/packages-test"
build "$directory"

log=$directory/ctest.log
code=0
ctest --test-dir "$directory" -j2 --output-on-failure "${selection[@]}" "$@" 2>&1 | tee "$log" || code=$?
# ctest's own summary: "100% tests passed, 0 tests failed out of 12"
summary='s/^[0-9]+% tests passed, ([0-9]+) tests? failed out of ([0-9]+)$/\1 \2/p'
read -r failed total < <(sed -nE "$summary" "$log") || true
if [ -z "${total:-}" ]; then
    echo "test.sh: ctest ran no tests; its log is $log" >&2
    failed=0
    total=0
    [ "$code" -ne 0 ] || code=1
fi
# sed and not head: head ends early, and sort, killed by the closed pipe, would fail the script (pipefail).
echo "The ten slowest tests, in seconds:"
sed -nE 's/^ *[0-9]+\/[0-9]+ Test +#[0-9]+: (.*[^.]) \.\.+ +[^.]*(Passed|Failed) +([0-9.]+) sec.*/  \3  \1/p' "$log" | sort -rn | sed -n '1,10p'
echo "$((total - failed)) passed, $failed failed"
exit "$code"
