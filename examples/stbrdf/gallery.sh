#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Enlargements of the seven specimens and of the published set, each rendered at five times: strips
# in out/stbrdf/gallery, the sample at the left. Run from the repository's root after make; the
# published set is looked for in $PATINA_TEST_DATA.
set -euo pipefail
patina=${PATINA:-build/patina}
out=out/stbrdf/gallery
times="0 0.25 0.5 0.75 1"
rm -rf "$out" && mkdir -p "$out"

# shot SET TIME FILE
shot() {
  rm -rf "$out/moment"
  "$patina" stbrdf evaluate "$1" --time "$2" --out "$out/moment" --quiet
  "$patina" render "$out/moment" --top --light 0.3,0.3,0.9 --out "$3" --quiet
}

# strip NAME SAMPLE_SET RESULT_SET SCALE: renders both under one lamp, the sample at 0.5.
strip() {
  shot "$2" 0.5 "$out/$1-sample.png"
  for t in $times; do shot "$3" "$t" "$out/$1-$t.png"; done
  /usr/bin/python3 - "$out/$1" "$4" $times <<'PY'
import sys, cv2, numpy as np
base, scale, times = sys.argv[1], float(sys.argv[2]), sys.argv[3:]
read = lambda t: cv2.resize(cv2.imread(f"{base}-{t}.png"), None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
tall, sample = [read(t) for t in times], read("sample")
pad = np.full((tall[0].shape[0] - sample.shape[0], sample.shape[1], 3), 255, np.uint8)
gap = np.full((tall[0].shape[0], 4, 3), 255, np.uint8)
parts = [np.vstack([sample, pad])]
for picture in tall: parts += [gap, picture]
cv2.imwrite(f"{base}.png", np.hstack(parts), [cv2.IMWRITE_PNG_COMPRESSION, 9])
PY
}

for name in banana_ripening copper_patination grass_growth paint_cracking snow_accumulation wood_drying steel_rusting; do
  for i in 0 1 2 3 4 5 6 7 8 9 10; do
    "$patina" twin specimens render "$name" --time "$(awk "BEGIN{print $i/10}")" --size 96x96 \
      --out "$out/$name-steps/t$(printf %04d "$i")" --quiet
  done
  "$patina" stbrdf fit "$out/$name-steps" --out "$out/$name" --quiet
  "$patina" stbrdf enlarge "$out/$name" "$out/$name-large" --size 192x192 --seed 1
  strip "$name" "$out/$name" "$out/$name-large" 1
done

if [ -n "${PATINA_TEST_DATA:-}" ]; then
  "$patina" stbrdf enlarge "$PATINA_TEST_DATA/snowyground_stbrdf" "$out/snow-large" --size 1024x1024 --seed 1
  strip snowyground "$PATINA_TEST_DATA/snowyground_stbrdf" "$out/snow-large" 0.25
fi
