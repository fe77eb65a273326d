#!/usr/bin/env bash
# ./web.sh: the live page and the site of all documents. Installs what is missing, compiles the library to WebAssembly,
# and says where the pages are. Open them from the folder or put it on any server.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
"$top/bridge/web/build.sh"
exec "$top/docs/build.sh"
