#!/bin/sh
# bundle_test.sh [ARCHIVE]: host/bundle's archive in a Debian with nothing installed (debootstrap's minbase): the program
# starts, computes on the CPU, draws, and says what it misses. Needs root and debootstrap; else it is skipped (exit 77).
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
. "$here/tests/e2e/bare_debian.sh"
archive=${1:-$here/$("$here/host/bundle")}
bare_debian bookworm "" "$archive"
cat >"$root/tmp/bump.toml" <<END
[surface]
kind = "bump"
facets = 2
[force]
shading = "reference"
[grid]
size = [32, 4, 16]
spacing = "0.8 mm"
END

inside forceshade --version
inside forceshade field /tmp/bump.toml --out /tmp/bump.exr --also png --engine cpu
for file in bump.exr bump.arrows.png bump.mosaic.png; do
    [ -s "$root/tmp/$file" ] || { echo "no $file" >&2; exit 1; }
done
# Without a driver doctor ends with 1, and says that it is the driver that is missing: the loader is the bundle's.
status=0
doctor=$(inside forceshade doctor 2>&1) || status=$?
echo "$doctor"
[ "$status" = 1 ]
echo "$doctor" | grep -q 'problem  Vulkan driver'
echo "$doctor" | grep -q 'ok       font of the pictures: DejaVu Sans'
if echo "$doctor" | grep -q 'no Vulkan loader'; then exit 1; fi
