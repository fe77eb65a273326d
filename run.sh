#!/usr/bin/env bash
# ./run.sh [SCENE] [options]: installs what is missing, builds, runs the scene (default: scenes/stack30.json) and says
# where the pictures are. Options go to `supercircle run`; the results are in out/<scene name> unless --out is given.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
me=run.sh
. "$top/.ci/setup.sh"

scene=$top/scenes/stack30.json
if [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; then
    scene=$1
    shift
    [ -e "$scene" ] || [ ! -e "$top/$scene" ] || scene=$top/$scene
fi
name=$(basename "$scene")
out=$top/out/${name%.json}
given=no
help=no
previous=
for argument in "$@"; do
    [ "$previous" = --out ] && out=$argument && given=yes
    case $argument in
    --out=*) out=${argument#--out=} && given=yes ;;
    -h | --help) help=yes ;;
    esac
    previous=$argument
done

trap 'give_back "$top/build" "$top/out"' EXIT
install_missing "$top/.ci/packages"
build "$top/build" supercircle
program=$top/build/bin/supercircle
[ "$help" = no ] || exec "$program" run --help
options=("$@")
[ "$given" = yes ] || options+=(--out "$out")

code=0
"$program" run "$scene" "${options[@]}" || code=$?
if [ "$code" -ne 0 ]; then
    echo "run.sh: the run ended with exit code $code" >&2
elif [ -e "$out/report.html" ]; then
    echo "Pictures: $out/report.html"
else
    echo "Results: $out"
fi
exit "$code"
