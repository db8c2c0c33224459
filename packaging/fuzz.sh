#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# fuzz.sh SECONDS [TARGET...]   each fuzzer of build-fuzz/ for so much processor time, however busy the machine, from the
# corpus of the tree. What it grows goes to build-fuzz/corpus/, what it finds to build-fuzz/found/: mend it, and add it to
# tests/fuzz/corpus/.
cd "$(dirname "$0")/.." || exit 70
seconds=$1
shift
targets=${*:-$(ls tests/fuzz/corpus)}
ticks=$(getconf CLK_TCK)

# spent PID: seconds of processor time so far; all there are of a fuzzer that has ended by itself.
spent() {
  awk -v ticks="$ticks" -v all="$seconds" '{ print $3 == "Z" ? all : int(($14 + $15) / ticks) }' "/proc/$1/stat" 2>/dev/null ||
    echo "$seconds"
}

mkdir -p build-fuzz/found
status=0
for target in $targets; do
  mkdir -p "build-fuzz/corpus/$target"
  build-fuzz/fuzz_"$target" -timeout=60 -rss_limit_mb=2048 -max_len=65536 \
    -artifact_prefix="build-fuzz/found/$target-" -print_final_stats=1 "build-fuzz/corpus/$target" \
    "tests/fuzz/corpus/$target" 2>"build-fuzz/$target.log" &
  fuzzer=$!
  used=0
  while [ "$used" -lt "$seconds" ]; do
    sleep 1
    used=$(spent $fuzzer)
  done
  kill -USR1 $fuzzer 2>/dev/null  # ends with its figures
  wait $fuzzer || status=1
  echo "$target: $(sed -n 's/^stat::number_of_executed_units: *//p' "build-fuzz/$target.log") runs," \
    "$(ls build-fuzz/found | grep -c "^$target-") findings"
done
exit $status
