#!/usr/bin/env bash
# compare.sh OLD_BUILD NEW_BUILD [--only NAME ...] [--set quick|slow|all] [--show N] [--jobs N]
# Makes the golden runs with two builds. Prints "equal" or the first N differences (1) of each; exit 1 if one differs.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [ $# -lt 2 ]; then
    sed -n '2,3s/^# //p' "${BASH_SOURCE[0]}" >&2
    exit 2
fi
old=$1 new=$2
shift 2
exec python3 "$here/golden.py" --build "$old" --against "$new" "$@"
