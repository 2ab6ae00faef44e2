#!/bin/sh
# mesa_test.sh [SUITE [ARCHIVE]]: the bundle on the software device of another Debian's Mesa (trixie: Mesa 25, LLVM 19):
# every law in both precisions, and cases of the paper's study, must have the oracle's bits. Skipped as bundle_test.sh is.
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
. "$here/tests/e2e/bare_debian.sh"
[ "$(id -u)" = 0 ] && command -v debootstrap >/dev/null || exit 77
archive=${2:-$here/$("$here/host/bundle")}
bare_debian "${1:-trixie}" mesa-vulkan-drivers "$archive"

inside forceshade gpus
inside forceshade doctor --gpu-report /tmp/gpu --quiet
cat "$root/tmp/gpu/report.md"
grep -q '"f64": true' "$root/tmp/gpu/report.json" # llvmpipe of this Mesa, not the machine's
inside forceshade validate --gpu llvmpipe --only '*radius-600mil*' --quiet
