#!/usr/bin/env bash
# examples/gallery.sh [BUILD_DIRECTORY]: makes the pictures of docs/results/gallery.md anew, without a window.
set -euo pipefail
top=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$(cd "${1:-$top/build}" && pwd)
out=$top/docs/pictures
cd "$top"

# play GAME LEVEL SCRIPT FRAMES
play() {
    "$build/bin/$1" "$2" --headless --script "tests/examples/$3.json" --frames "$4" --png "$out/gallery_$1.png"
}
play egg_drop 2 egg_drop_2_played 1130
play lander 3 lander_3_won 275
play clip 2 clip_2_won 950
"$build/bin/supercircle" view scenes/two_shells.json --headless --frames 260 --show energy,contacts,slip \
    --png "$out/gallery_view.png"
"$build/bin/supercircle" view scenes/stack30.json --param shells=5 --param width=0.08 --headless --frames 700 \
    --script tests/examples/view_close.json --show curvature,contacts --png "$out/gallery_stack.png"
ls -l "$out"/gallery_*.png
