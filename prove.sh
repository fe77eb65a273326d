#!/usr/bin/env bash
# ./prove.sh [--seed N] [--first K] [--state FOLDER] [--jobs N]: makes a blind set of recordings, diagnoses it, opens the
# answers and prints the scores (docs/results/claims.md). Installs what is missing and builds first. The same command
# continues a run that was stopped. `./prove.sh --seed 12345 --first 6` is meant for half an hour on two cores.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
me=prove.sh
. "$top/.ci/setup.sh"

trap 'give_back "$top/build" "$top/out"' EXIT
install_missing "$top/.ci/packages" "$top/.ci/packages-prove"
build "$top/build" supercircle supercircle-identify synthetic_cases
# The system's Python: another one on PATH may lack SciPy.
code=0
env PYTHONDONTWRITEBYTECODE=1 OMP_NUM_THREADS=1 /usr/bin/python3 "$top/tests/blind_benchmark/proof/prove.py" "$@" || code=$?
exit "$code"
