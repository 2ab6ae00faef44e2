#!/bin/bash
# What Tab completes in bash: the script is sourced, its function called as readline calls it.
#   completion_test.sh PROGRAM
set -u
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin"
ln -s "$1" "$folder/bin/forceshade"
PATH=$folder/bin:$PATH
cd "$folder"
source <(forceshade completion bash)
cat > own.toml <<'TOML'
[surface]
kind = "bump"
radius = ["20 mm", "30 mm"]
TOML
failed=0

# expect 'CANDIDATES' WORD...: the last word is the one at the cursor, unless AT says which.
expect() {
    local wanted=$1
    shift
    COMP_WORDS=("$@") COMP_CWORD=${AT:-$(($# - 1))}
    _forceshade
    [ "${COMPREPLY[*]}" = "$wanted" ] || {
        echo "$* at $COMP_CWORD: \"${COMPREPLY[*]}\", wanted \"$wanted\"" >&2
        failed=1
    }
}

expect 'field' forceshade f
expect 'run analyse plan' forceshade experiment ''
expect 'explore experiment' forceshade help ex
expect 'run' forceshade help experiment r
expect '--quantity --quiet' forceshade field bump.toml --qu
expect '--quantity' forceshade field -q --qu
expect 'auto gpu cpu' forceshade field bump.toml --engine ''
expect 'cpu' forceshade field bump.toml --engine = c
expect 'f64' forceshade --precision f6
expect 'f32 f64' forceshade --precision ''
expect 'png,npy' forceshade field --also png,n
expect 'npy,vti npy,vtp npy,png npy,svg npy,pdf' forceshade sweep --also npy,
expect 'vtp,npy vtp,html vtp,png vtp,svg vtp,pdf' forceshade explore --also vtp,
expect 'vti vtp' forceshade field --also vt
expect 'error-time energy' forceshade study e
expect 'bash zsh fish' forceshade completion ''
expect 'bump_radius-20mm bump_radius-30mm' forceshade sweep own.toml --only ''
expect 'bump_radius-30mm' forceshade validate own.toml --only "'bump_radius-3"
AT=3 expect 'bump_radius-20mm' forceshade sweep --only bump_radius-2 own.toml --out x
expect 'bump_radius-600mil_facets-2_shading-none bump_radius-600mil_facets-2_shading-reference' \
    forceshade sweep --only bump_radius-600mil_facets-2
# Files are readline's own.
expect '' forceshade field ''
[ "$(forceshade __complete 2 forceshade field '')" = :files ] || failed=1
[ "$(forceshade __complete 4 forceshade field bump.toml --out '')" = :files ] || failed=1
expect '' forceshade gpus ''
expect '' forceshade nonsense ''
expect '' forceshade sweep no.toml --only ''
exit "$failed"
