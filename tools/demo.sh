#!/usr/bin/env bash
# The first look: installs what is needed, builds Release into build/demo, plays assets/clips/first_light.json on the
# reference head, and leaves out/first_light.mp4, out/frames/*.png and out/contact.png.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/demo
out=$root/out
log=$build/build.log

"$root/tools/setup.sh"

mkdir -p "$build" "$out"
echo "demo: building (log: ${log#"$root"/})"
if ! { cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DRISORIUS_TESTS=OFF &&
       cmake --build "$build" -j"$(nproc)"; } >"$log" 2>&1; then
  tail -n 40 "$log" >&2
  echo "demo.sh: the build failed; the whole log is $log" >&2
  exit 1
fi

risorius=$build/bin/risorius
head=$root/assets/human
clip=$root/assets/clips/first_light.json

echo "demo: simulating and rendering"
rm -rf -- "$out/frames"
"$risorius" render "$head" --clip "$clip" --view front,34 --size 480x540 --fps 30 \
  -o "$out/first_light.mp4" -o "$out/frames/%04d.png" --contact "$out/contact.png"

echo "demo: GPU against CPU"
"$risorius" compare "$head" --clip "$clip"

echo "demo: look at out/contact.png and out/first_light.mp4"
