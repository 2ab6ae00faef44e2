# Sourced by host/run and tests/run: installs missing packages and builds. POSIX sh.

# install_packages FILE...: of the packages listed, installs those that are missing; root or sudo.
install_packages() {
    missing=
    for package in $(cat "$@" | sed 's/#.*//'); do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing="$missing $package"
    done
    [ -n "$missing" ] || return 0
    echo "installing:$missing" >&2
    as_root=
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null || {
            echo "these packages are missing and neither root nor sudo is at hand:$missing" >&2
            return 1
        }
        as_root=sudo
    fi
    # A list of packages may be missing or old: fetch a new one only if the first try fails.
    # shellcheck disable=SC2086
    $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing >&2 ||
        { $as_root apt-get update -q >&2 &&
            $as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing >&2; }
}

# build FOLDER OPTION...: configures if need be and builds what changed.
build() {
    folder=$1
    shift
    [ -f "$folder/build.ninja" ] || cmake -S . -B "$folder" -G Ninja -DCMAKE_BUILD_TYPE=Release "$@" >&2 || return 1
    cmake --build "$folder" >&2
}
