#!/bin/sh
# bin/forceshade of a bundle: starts the program with its own fonts and, where the machine has none or an older one, its
# own C++ library and Vulkan loader.
root=$(dirname "$(dirname "$(readlink -f "$0")")")
case $(uname -m) in aarch64) kind=AArch64 ;; *) kind=x86-64 ;; esac

# machines_file NAME: the machine's file of that library; empty: it has none.
machines_file() {
    PATH=$PATH:/sbin:/usr/sbin ldconfig -p 2>/dev/null | grep -F "$1 (libc6,$kind" | sed -n 's/.* => //p' | head -n 1
}
# version FILE: the newest of the C++ library's versions that it offers.
version() { grep -aoE 'GLIBCXX_3\.4\.[0-9]+' "$1" | sort -Vu | tail -n 1; }

path=$LD_LIBRARY_PATH
theirs=$(machines_file libstdc++.so.6)
newest=$(version "$root/lib/c++/libstdc++.so.6")
if [ -n "$theirs" ]; then
    newest=$(printf '%s\n' "$newest" "$(version "$theirs")" | sort -V | tail -n 1)
    [ "$(version "$theirs")" = "$newest" ] || theirs=
fi
[ -n "$theirs" ] || path=$root/lib/c++${path:+:$path}
[ -n "$(machines_file libvulkan.so.1)" ] || path=$root/lib/vulkan${path:+:$path}
[ -z "$path" ] || export LD_LIBRARY_PATH="$path"
export FONTCONFIG_FILE="${FONTCONFIG_FILE:-$root/share/fonts.conf}"
exec "$root/lib/forceshade" "$@"
