#!/bin/sh
# deb_test.sh [PACKAGE]: host/deb's package in a Debian with nothing installed (debootstrap's minbase), where apt fetches
# what it needs: the program does its main job without compiler or sources, the manual is there, Python finds the module.
# Needs root, debootstrap and a package mirror; else it is skipped (exit 77).
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
[ "$(id -u)" = 0 ] && command -v debootstrap >/dev/null || exit 77
package=${1:-$("$here/host/deb")}
root=$(mktemp -d)
trap 'umount "$root/proc" 2>/dev/null || true; rm -rf "$root"' EXIT
mirror=$(sed -n 's/^deb \(\[[^]]*\] \)\?\([^ ]*\) .* main.*/\2/p; s/^URIs: *\([^ ]*\).*/\1/p' /etc/apt/sources.list \
    /etc/apt/sources.list.d/* 2>/dev/null | head -n 1)
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$root.log" 2>&1 || { cat "$root.log"; exit 77; }
rm -f "$root.log"
mount -t proc proc "$root/proc" || exit 77 # a program finds the folder it lies in there
cp "$package" "$root/tmp/"
for file in /etc/resolv.conf /etc/apt/apt.conf.d/*; do
    cp "$file" "$root$file" 2>/dev/null || true
done

inside() { chroot "$root" env -i PATH=/usr/bin:/bin:/usr/sbin:/sbin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
inside apt-get install -y -q --install-recommends "/tmp/$(basename "$package")" >"$root.log" 2>&1 || { cat "$root.log"; exit 1; }
rm -f "$root.log"
inside forceshade --version
[ "$(inside sh -c 'command -v g++ cmake || true')" = "" ]
inside sh -c 'cd /tmp && forceshade init bump --out bump.toml && forceshade field bump.toml --out bump.exr --also png,npy'
for file in bump.exr bump.arrows.png bump.force.npy; do
    [ -s "$root/tmp/$file" ] || { echo "no $file" >&2; exit 1; }
done
inside forceshade doctor || true
[ -s "$root/usr/share/zsh/vendor-completions/_forceshade" ]
[ -s "$root/usr/share/man/man1/forceshade-field.1" ]
inside python3 -c 'import forceshade, numpy
field = forceshade.Scene.load("/tmp/bump.toml").field()
assert (field.force == numpy.load("/tmp/bump.force.npy")).all()'
inside apt-get remove -y -q forceshade >/dev/null
[ "$(find "$root/usr" -name '*forceshade*' | grep -v /var/ || true)" = "" ]
