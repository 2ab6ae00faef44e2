# Sourced: a Debian with little in it, for the bundle. Needs root and debootstrap; else the test is skipped (exit 77).

# bare_debian SUITE PACKAGES ARCHIVE: into $root, with the bundle in /opt/bundle; gone at the end. PACKAGES: with commas, or "".
bare_debian() {
    [ "$(id -u)" = 0 ] && command -v debootstrap >/dev/null || exit 77
    root=$(mktemp -d)
    trap 'umount "$root/proc" 2>/dev/null || true; rm -rf "$root"' EXIT
    debootstrap --variant=minbase ${2:+--include="$2"} "$1" "$root" >"$root.log" 2>&1 || { cat "$root.log"; rm -f "$root.log"; exit 77; }
    rm -f "$root.log"
    mount -t proc proc "$root/proc" || exit 77 # a program finds the folder it lies in there
    mkdir "$root/opt/bundle"
    tar -C "$root/opt/bundle" --strip-components=1 -xf "$3"
    ln -s /opt/bundle/bin/forceshade "$root/usr/local/bin/forceshade"
}

inside() { chroot "$root" env -i PATH=/usr/local/bin:/usr/bin:/bin HOME=/root "$@"; }
