#!/usr/bin/env bash
# Makes the contact sheets of the vocabularies anew: tools/sheets.sh [RISORIUS [OUT]]
# 256 colours without dithering keep a sheet near one megabyte; needs ffmpeg.
set -euo pipefail
cd "$(dirname "$0")/.."
risorius=${1:-build/release/bin/risorius}
out=${2:-docs/images}
raw=$(mktemp -d)
trap 'rm -rf "$raw"' EXIT

sheet() { # name, then what `risorius sheet` takes
  local name=$1
  shift
  "$risorius" sheet assets/human --device cpu -q "$@" -o "$raw/$name.png"
  ffmpeg -v error -y -i "$raw/$name.png" -vf 'split[a][b];[a]palettegen=stats_mode=full[p];[b][p]paletteuse=dither=none' \
    "$out/$name.png"
  echo "$out/$name.png: $(wc -c < "$out/$name.png") bytes"
}

sheet facs --set facs --columns 5 --size 190x205
sheet arkit --set arkit --columns 8 --size 190x205 --view front
sheet visemes --set visemes --columns 5 --size 190x205 --zoom 2
sheet expressions --set expressions --columns 6 --size 160x175 --zoom 1.2
