#!/usr/bin/env bash
# docs/build.sh [--no-install]: makes the site build/site of all documents, with the page of live scenes in front if
# bridge/web/build.sh has made its module. Opens from a file or from a server; asks no network.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
me=docs/build.sh
. "$top/.ci/setup.sh"
trap 'give_back "$top/build"' EXIT
if [ "${1:-}" = --no-install ]; then
    python=/usr/bin/python3 # the one that Debian's packages are for
    "$python" -c 'import markdown' 2>/dev/null || { echo "skipped: python3-markdown is missing; docs/build.sh installs what the site needs"; exit 77; }
else
    install_missing "$top/.ci/packages-site"
    python=/usr/bin/python3
fi
directory=$top/build/site
mkdir -p "$top/build"
options=()
if command -v doxygen >/dev/null; then
    mkdir -p "$top/build/reference"
    quiet_step "doxygen" "$top/build/doxygen.log" env -C "$top" doxygen docs/Doxyfile
    options+=(--reference "$top/build/reference/html")
fi
if [ -e "$top/build/web/package/supercircle.wasm" ]; then
    quiet_step "the page" "$top/build/play.log" \
        "$python" "$top/docs/site/play/build.py" --package "$top/build/web/package" --out "$top/build/play/index.html"
    options+=(--play "$top/build/play/index.html")
fi
"$python" "$top/docs/site/build_site.py" --out "$directory" "${options[@]}"
echo "Site: $directory/index.html"
[ -e "$directory/play/index.html" ] || echo "Without live scenes: bridge/web/build.sh makes their module"
