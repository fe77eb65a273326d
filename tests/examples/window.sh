#!/usr/bin/env bash
# window.sh SUPERCIRCLE CLIP SCENES TESTS: opens real windows on a display of its own (Xvfb) and uses them like a person:
# a click on a button, a drag of a clip, Escape. Then TESTS compares what a window shows with what a PNG has. Exit code
# 77 (skipped) where Xvfb or xdotool are missing.
set -u
supercircle=$1 clip=$2 scenes=$3 tests=$4
for tool in Xvfb xdotool; do
    command -v "$tool" >/dev/null || { echo "skipped: there is no $tool"; exit 77; }
done
work=$(mktemp -d)
server= program=
cleanup() {
    [ -n "$program" ] && kill "$program" 2>/dev/null
    [ -n "$server" ] && kill "$server" 2>/dev/null
    rm -rf "$work"
}
trap cleanup EXIT
fail() {
    echo "window.sh: $*" >&2
    cat "$work"/*.txt >&2
    exit 1
}

# The server picks a free display number and writes it down.
exec 5>"$work/display"
Xvfb -displayfd 5 -screen 0 1400x900x24 -nolisten tcp >"$work/server.txt" 2>&1 &
server=$!
for _ in $(seq 100); do
    [ -s "$work/display" ] && break
    sleep 0.1
done
[ -s "$work/display" ] || fail "Xvfb does not start"
DISPLAY=:$(cat "$work/display")
export DISPLAY
export LIBGL_ALWAYS_SOFTWARE=1

# start NAME COMMAND...: waits for a window whose title has NAME.
start() {
    local name=$1
    shift
    "$@" >"$work/said.txt" 2>"$work/complained.txt" &
    program=$!
    for _ in $(seq 200); do
        window=$(xdotool search --name "$name" 2>/dev/null | sed -n 1p)
        [ -n "$window" ] && break
        kill -0 "$program" 2>/dev/null || fail "$name ended before it had a window"
        sleep 0.1
    done
    [ -n "$window" ] || fail "$name shows no window"
    xdotool windowmove --sync "$window" 0 0
    sleep 1
}
# leave: Escape, and it must end by itself with exit code 0.
leave() {
    xdotool key --window "$window" Escape
    for _ in $(seq 100); do
        kill -0 "$program" 2>/dev/null || break
        sleep 0.1
    done
    kill -0 "$program" 2>/dev/null && fail "Escape does not close the window"
    wait "$program" || fail "the program ended with exit code $?"
    program=
}

# interrupt SIGNAL: one signal, and it must end by itself with exit code 130.
interrupt() {
    kill "-$1" "$program"
    for _ in $(seq 100); do
        kill -0 "$program" 2>/dev/null || break
        sleep 0.1
    done
    kill -0 "$program" 2>/dev/null && fail "one SIG$1 does not end the program"
    wait "$program"
    local code=$?
    [ "$code" = 130 ] || fail "after SIG$1 the program ended with exit code $code"
    program=
}

# The testbed: a click on "Pause" holds the scene, so that its clock stands still; its last line says so.
start Supercircle "$supercircle" view "$scenes/two_shells.json"
xdotool mousemove 55 72 sleep 0.3 mousedown 1 sleep 0.3 mouseup 1
sleep 1.5
leave
grep -q "paused" "$work/said.txt" || fail "the click on Pause had no effect"

# The game: drag the waiting clip upwards; it prints how often something was dragged.
start Clip "$clip" 1
xdotool mousemove 114 432 sleep 0.3 mousedown 1 sleep 0.3
for y in 400 380 360 340 320 300; do
    xdotool mousemove 140 $y sleep 0.1
done
sleep 0.5
xdotool mouseup 1
leave
grep -q "dragged [1-9]" "$work/said.txt" || fail "the mouse dragged nothing"
# One signal ends either, and the result is printed.
for signal in INT TERM; do
    start Supercircle "$supercircle" view "$scenes/two_shells.json"
    interrupt $signal
    grep -q "^two_shells: " "$work/said.txt" || fail "view ended by SIG$signal does not print its time"
    start Clip "$clip" 1
    interrupt $signal
    grep -q "^clip 1: playing" "$work/said.txt" || fail "a game ended by SIG$signal does not print its result"
done
"$tests" "[window]" >"$work/said.txt" 2>&1 || fail "windows and PNG files show something else"
echo "windows open, react to clicks and drags, and close"
