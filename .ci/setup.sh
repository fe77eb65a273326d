# shellcheck shell=bash disable=SC2154
# Sourced by run.sh, test.sh and .ci/run: install what is missing, run one step quietly, build.
# Expects `top` (the project's root) and `me` (the script's name for messages).

fail() {
    echo "$me: $*" >&2
    exit 1
}

# quiet_step WHAT LOG COMMAND...: nothing on success; on failure one line, the end of the log, and where the log is.
quiet_step() {
    local what=$1 log=$2 code=0
    shift 2
    "$@" >"$log" 2>&1 || code=$?
    [ "$code" -eq 0 ] && return 0
    echo "$me: $what failed (exit $code); the last lines of $log:" >&2
    # The compiler's own complaints first: the log ends with whatever job happened to finish last.
    { grep -m 8 -E 'error:|Error |^E: ' "$log" || tail -n 15 "$log"; } | sed 's/^/    /' >&2
    exit "$code"
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        env DEBIAN_FRONTEND=noninteractive "$@"
    else
        sudo env DEBIAN_FRONTEND=noninteractive "$@"
    fi
}

# install_missing LIST...: apt-get for the packages of these lists that are not installed; silent when all are.
install_missing() {
    local wanted missing=() package
    mapfile -t wanted < <(grep -hv -e '^#' -e '^$' "$@")
    if ! command -v dpkg-query >/dev/null 2>&1; then
        echo "$me: not a Debian machine, so nothing is installed; needed are: ${wanted[*]}" >&2
        return 0
    fi
    for package in "${wanted[@]}"; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
    done
    [ ${#missing[@]} -eq 0 ] && return 0
    if [ "$(id -u)" -ne 0 ] && ! command -v sudo >/dev/null 2>&1; then
        fail "these packages are missing and neither root nor sudo is there to install them: ${missing[*]}"
    fi
    echo "$me: installing ${missing[*]}"
    mkdir -p "$top/build"
    quiet_step "apt-get update" "$top/build/apt.log" as_root apt-get -q update
    quiet_step "apt-get install" "$top/build/apt.log" \
        as_root apt-get -q -y --no-install-recommends install "${missing[@]}"
}

# Eigen and JSON headers cost the compiler about a gigabyte a job: never more jobs than the memory carries.
build_jobs() {
    local cores memory
    cores=$(nproc)
    memory=$(awk '/MemAvailable/ { print int($2 / 1000000) }' /proc/meminfo 2>/dev/null || echo "$cores")
    [ "${memory:-0}" -ge 1 ] || memory=1
    echo $((cores < memory ? cores : memory))
}

# build DIRECTORY [TARGET...]: run.sh and test.sh share one folder, so that nothing is built twice.
build() {
    local directory=$1
    shift
    [ -e "$directory/build.ninja" ] || echo "$me: building (the first time takes some minutes)"
    mkdir -p "$directory" || fail "cannot create $directory"
    local launcher=()
    ! command -v ccache >/dev/null 2>&1 || launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    quiet_step "configuring" "$directory/configure.log" \
        cmake -S "$top" -B "$directory" -G Ninja -DCMAKE_BUILD_TYPE=Release "${launcher[@]}"
    quiet_step "building" "$directory/build.log" ninja -C "$directory" -j "$(build_jobs)" "$@"
}

# Under sudo the files made belong to the user who called it, so that the next call works without sudo.
give_back() {
    [ -n "${SUDO_UID:-}" ] && [ "$(id -u)" -eq 0 ] || return 0
    local made
    for made in "$@"; do
        [ -e "$made" ] && chown -R "$SUDO_UID:${SUDO_GID:-$SUDO_UID}" "$made"
    done
    return 0
}
