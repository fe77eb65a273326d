#!/usr/bin/env bash
# bridge/python/build.sh: installs what is missing and builds the two libraries that the Python package calls.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
me=build.sh
. "$top/.ci/setup.sh"
trap 'give_back "$top/build"' EXIT
install_missing "$top/.ci/packages" "$top/.ci/packages-test"
build "$top/build" supercircle_c supercircle_lab_c
echo "Libraries: $top/build"
echo "Try them: PYTHONPATH=$top/bridge/python/src /usr/bin/python3 -c 'import supercircle as sc; print(sc.run(\"two_shells\"))'"
