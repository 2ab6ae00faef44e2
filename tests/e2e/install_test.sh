#!/bin/sh
# What cmake --install puts where: the program, a page of the manual for every command, completions, the keys of a scene,
# the Python module, and the oracle as a library, with which a program of somebody's own is built.
#   install_test.sh BUILD
set -eu
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$1" --prefix "$folder" > /dev/null
"$folder/bin/forceshade" --version > /dev/null
cd "$folder/share"
bash -n bash-completion/completions/forceshade
grep -q '^#compdef forceshade' zsh/site-functions/_forceshade
grep -q '^complete -c forceshade' fish/vendor_completions.d/forceshade.fish
for command in $("$folder/bin/forceshade" __complete 1 forceshade '' | cut -f 1); do
    page=man/man1/forceshade-$command.1
    grep -q '^\.SH EXAMPLES' "$page"
    grep -q "^\.BR forceshade.*$(echo "$command" | sed 's/-/.*/g') (1)" man/man1/forceshade.1
done
grep -q 'participant' man/man1/forceshade-experiment-run.1
if command -v groff > /dev/null; then
    for page in man/man1/*; do
        complaints=$(groff -man -ww -Tutf8 "$page" 2>&1 > /dev/null)
        [ -z "$complaints" ] || { echo "$complaints" >&2; exit 1; }
    done
fi
grep -q '"surface.radius"' forceshade/schema.json

cd "$folder"
cat > scene.toml <<END
[surface]
kind = "bump"
facets = 3
[force]
shading = "reference"
[run]
precision = "f64"
END
cmake -S "$here/../../host/library/examples" -B examples -DCMAKE_PREFIX_PATH="$folder" > /dev/null
cmake --build examples > /dev/null
for example in loop touch headers; do
    "examples/$example" > "$example.txt"
done
grep -q '^0.275 s: 0.989406 0.659604 3.298020 N, facet 1$' loop.txt
grep -q '^again: touching, ' touch.txt
grep -q '^error 3: .*stiffness' touch.txt
examples/feel scene.toml > felt.csv
bin/forceshade explore scene.toml --paths felt.csv --out explored.csv --engine cpu --quiet
cat > same.py <<END
import csv
felt, explored = (list(csv.DictReader(open(name))) for name in ("felt.csv", "explored.csv"))
assert len(felt) == len(explored) == 100
assert any(float(row["fx"]) != 0 for row in felt)
for one, other in zip(felt, explored):
    assert all(float(one[key]) == float(other[key]) for key in ("fx", "fy", "fz"))
    assert float(one["field_fz"]) == float(one["fz"])
try:
    import forceshade
except ModuleNotFoundError:
    assert not "$(find . -name '_native*.so')" # without Python's headers there is none
else:
    force = forceshade.Scene.load("scene.toml").forces([[float(row[axis]) for axis in "xyz"] for row in felt])
    assert force[:, 2].tolist() == [float(row["fz"]) for row in felt]
END
module=$(find "$folder/lib" -name '_native*.so' | head -n 1)
PYTHONPATH=${module%/forceshade/*} /usr/bin/python3 same.py
echo '[surface' > scene.toml
if examples/feel scene.toml > felt.csv 2> complaint; then exit 1; fi
grep -q 'scene.toml:1:' complaint
