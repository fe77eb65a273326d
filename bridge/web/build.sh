#!/usr/bin/env bash
# bridge/web/build.sh [--no-install]: builds the JavaScript package, build/web/supercircle-VERSION.tgz, and the folder
# build/web/package that it is packed from. Installs what is missing, unless told not to: then exit code 77 says that
# something is missing. A page without npm takes supercircle.js and supercircle.wasm from the folder.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
me=build.sh
. "$top/.ci/setup.sh"
trap 'give_back "$top/build"' EXIT
directory=$top/build/web

if [ "${1:-}" = --no-install ]; then
    for command in em++ node cmake ninja dpkg-source; do
        command -v "$command" >/dev/null || { echo "skipped: $command is missing; bridge/web/build.sh installs what the web build needs"; exit 77; }
    done
else
    install_missing "$top/.ci/packages-web"
    # Debian's npm is in the way of other builds of node: only where there is none.
    if ! command -v npm >/dev/null; then
        quiet_step "apt-get install npm" "$top/build/apt.log" as_root apt-get -q -y --no-install-recommends install npm
    fi
fi
# Of Debian's emscripten; another one names itself.
toolchain=${EMSCRIPTEN:-/usr/share/emscripten}/cmake/Modules/Platform/Emscripten.cmake
[ -e "$toolchain" ] || fail "there is no $toolchain: set EMSCRIPTEN to the folder of emcc"

mkdir -p "$directory"
quiet_step "fetching sources" "$directory/sources.log" "$top/.ci/sources" "$directory/sources"
[ -e "$directory/build.ninja" ] || echo "$me: building (the first time takes some minutes)"
quiet_step "configuring" "$directory/configure.log" cmake -S "$top" -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_TOOLCHAIN_FILE="$toolchain" -DEigen3_DIR=/usr/share/eigen3/cmake
quiet_step "building" "$directory/build.log" ninja -C "$directory" -j "$(build_jobs)"
if command -v npm >/dev/null; then
    quiet_step "npm pack" "$directory/pack.log" npm pack --offline --pack-destination "$directory" "$directory/package"
    echo "Package: $(ls "$directory"/supercircle-*.tgz)"
fi
echo "Files of a page: $directory/package/supercircle.js, $directory/package/supercircle.wasm"
