#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# demo.sh [FOLDER]   Seven days of a ripening banana on the simulated rig, with trouble on the way, to a film.
# Everything here is an ordinary `patina` command; the results stand in FOLDER (default out/demo).
set -euo pipefail
cd "$(dirname "$0")/.."
out=${1:-out/demo}
patina=build/patina
started=$SECONDS
step=0

say() { step=$((step + 1)); printf '\n[%d/8] %s\n' "$step" "$*"; }
run() { printf '      $ %s\n' "$(printf '%s ' "${@/#$patina/patina}")"; "$@"; }

rm -rf "$out"
mkdir -p "$out"
archive=$out/archive

say "First the camera is calibrated: 16 darks and 16 flats of a grey card under each of two lamps."
run $patina rehearse examples/banana/calibration.toml --archive "$archive" --quiet
run $patina calibrate dark latest --light off --archive "$archive" --quiet
run $patina calibrate flat latest --light key --archive "$archive" --quiet
run $patina calibrate flat latest --light fill --archive "$archive" --quiet

say "A week is rehearsed: one camera, two lamps, a banana, a picture under each lamp every 10 minutes for seven days.
      The days are simulated, the code is that of a real run. On the way a lamp drifts, another dies for 40 minutes, the
      camera hangs, and the power fails: what was not yet on the disk is lost, and the run must go on by itself."
run $patina rehearse examples/banana/plan.toml --archive "$archive"

say "Is every frame there, and is it what was stored? Every hash and every row is checked."
run $patina archive verify --archive "$archive"

say "The frames under one lamp become a time-varying texture (TTF): calibrated, linear, one volume for all steps.
      A second one takes every fourth step, for the synthesis."
run $patina ttf build --archive "$archive" --run latest --light key --out "$out/banana.h5"
run $patina ttf build --archive "$archive" --run latest --light key --every 4 --out "$out/banana-every4.h5"

say "From it a banana skin of four times the area is quilted: blocks of surface, each with its whole history.
      What is left of the steps across seams is spread over 12 pixels beside them, the same for all frames."
run $patina synth quilt "$out/banana-every4.h5" --size 1024x880 --blend 12 --out "$out/quilted.h5"

say "Films of both."
run $patina film "$out/banana.h5" "$out/banana.mp4"
run $patina film "$out/quilted.h5" "$out/quilted.mp4"

say "Pictures that tell the week: contact sheet, keogram, and the light with its verdicts."
run $patina sheet "$out/banana.h5" "$out/sheet.png"
run $patina keogram latest "$out/keogram.png" --archive "$archive" --light key
run $patina light report latest --archive "$archive" --out "$out/light.png"

say "The report: what was captured, held, skipped, missed and failed, and why."
run $patina archive report latest --archive "$archive" --out "$out"

printf '\nDone in %d s. Look at %s/report.html (or report.md), then at\n' $((SECONDS - started)) "$out"
printf '  %s/banana.mp4   the specimen, seven days in seconds\n  %s/quilted.mp4  four times the area, synthesised\n' "$out" "$out"
printf '\nYour own pictures:\n  %s import FOLDER --archive my-archive --specimen NAME --times exif\n' "$patina"
