#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# gallery.sh [FOLDER]   The films of docs/gallery/control from the twin's specimens, by ordinary commands. About 80 s
# of processor time; what lies between stays in FOLDER (default out/control).
set -euo pipefail
cd "$(dirname "$0")/../.."
work=${1:-out/control}
gallery=$work/gallery
patina=build/patina
here=examples/control

run() { printf '$ %s\n' "$(printf '%s ' "${@/#$patina/patina}")"; "$@" --quiet; }

# texture NAME SPECIMEN: a specimen's film as a time-varying texture.
texture() {
  [ -e "$work/$1.h5" ] && return
  run $patina twin specimens film "$2" --size 224x224 --frames 48 --out "$work/$1.mp4"
  run $patina import "$work/$1.mp4" --specimen "$2" --interval 1h --archive "$work/archive"
  run $patina ttf build --archive "$work/archive" --run latest --out "$work/$1.h5"
}
# shown NAME FILE [OPTIONS]: a film and five of its frames.
shown() {
  run $patina film "$2" "$gallery/$1.mp4" --fps 12 --crf 26 "${@:3}"
  run $patina sheet "$2" "$gallery/$1.png" --cells 5 --columns 5 --cell-width 176 "${@:3}"
}

mkdir -p "$gallery"
texture grass grass_growth
texture snow snow_accumulation
texture paint paint_cracking
texture copper copper_patination
rm -rf "$work/matte"

# Figure 9a: grass under a lamp 85 mm above it, equation 9.
run $patina ttf retime "$work/grass.h5" --mm-per-texel 0.5 --lamp -18,14,85 --rate '0.1 + 0.9*light' --out "$work/lamp.h5"
shown lamp "$work/lamp.h5"

# Figure 9b: paint over a sigmoid, equations 10 and 11; the mesh in its file, the curvature by its texture coordinates.
run $patina ttf retime "$work/paint.h5" --mesh $here/sigmoid.obj --rate '0.1 + 25*abs(curvature)' --out "$work/sigmoid.h5"
shown sigmoid "$work/sigmoid.h5"

# Figure 9c: snow that spells a word.
run $patina ttf retime "$work/snow.h5" --map $here/word.png --rate '0.06 + 0.94*map' --out "$work/word.h5"
shown word "$work/word.h5"

# Figure 10: a ball and its shadow off a photograph; the shadow slows the grass, the ball lies over it.
run $patina render $here/ball.toml --out "$work/photo.png"
run $patina ttf key "$work/photo.png" --background '#58c068' --out "$work/matte"
run $patina ttf retime "$work/grass.h5" --map "$work/matte/shadow.png" --rate '0.15 + 0.85*map' --out "$work/shade.h5"
shown ball "$work/shade.h5" --overlay "$work/matte"
cp "$work/photo.png" "$gallery/ball_photo.png"

# Figures 1 and 8: textures on objects.
awk -f $here/vase.awk > "$work/vase.obj"
cp $here/garden.toml "$work/"
run $patina render "$work/garden.toml" --frames 40 --rate 10 --crf 24 --out "$gallery/garden.mp4" --strip "$gallery/garden.png"

ls -l "$gallery"
