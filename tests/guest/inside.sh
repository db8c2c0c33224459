#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# inside.sh CASE   runs cases/CASE.sh in the guest. A line a check: PASS, FAIL or SKIPPED with the reason.
# Exits 0 when all passed, 77 when none ran, 1 when one failed.
passed=0
failed=0
skipped=0
programs=$PATINA_BUILD/tests
modules=$PATINA_CACHE/modules

# check WHAT COMMAND...: passes when the command does; its exit code 77 is a skip.
check() {
  local what=$1 code
  shift
  "$@"
  code=$?
  case $code in
    0) passed=$((passed + 1)) && echo "PASS $what" ;;
    77) skip "$what" "$1 says it cannot run here" ;;
    *) failed=$((failed + 1)) && echo "FAIL $what: exit code $code" ;;
  esac
}

# gtests PROGRAM FILTER: the program once, and a line for each of its tests.
gtests() {
  local output=/run/gtests before=$((passed + skipped)) failed_before=$failed code word name rest
  "$programs/$1" --gtest_filter="$2" --gtest_color=no >"$output" 2>&1
  code=$?
  cat "$output"
  grep -E '^\[ +(OK|FAILED|SKIPPED) +\].* ms\)$' "$output" >"$output.ends"
  while read -r _ word _ name rest; do
    case $word in
      OK) passed=$((passed + 1)) && echo "PASS $name" ;;
      FAILED) failed=$((failed + 1)) && echo "FAIL $name" ;;
      SKIPPED) skip "$name" "it says why above" ;;
    esac
  done <"$output.ends"
  [ "$failed" -gt "$failed_before" ] && return
  [ "$code" -eq 0 ] && [ $((passed + skipped)) -gt "$before" ] && return
  failed=$((failed + 1))
  echo "FAIL $1: exit code $code, $((passed + skipped - before)) tests came to an end"
}

skip() {
  skipped=$((skipped + 1))
  echo "SKIPPED $1: $2"
}

end() {
  echo "$passed passed, $failed failed, $skipped skipped"
  [ "$failed" -gt 0 ] && exit 1
  [ "$passed" -eq 0 ] && exit 77
  exit 0
}

# own_module NAME: a module of our own build; ends the case with the reason where there is none.
own_module() {
  if [ ! -e "$modules/$1.ko" ]; then
    skip "$1" "$(cat "$modules/$1.why" 2>/dev/null || echo "the module was not built")"
    end
  fi
  insmod "$modules/$1.ko"
}

# program NAME: its path; ends the case where it was not built.
need_program() {
  [ -x "$programs/$1" ] && return
  skip "$1" "the program is not in this build"
  end
}

# soon COMMAND...: true as soon as the command is, false after 20 s.
soon() {
  local tries
  for ((tries = 0; tries < 200; tries++)); do
    "$@" 2>/dev/null && return 0
    sleep 0.1
  done
  return 1
}

cd /
ip link set lo up 2>/dev/null
mkdir -p "$HOME"
# shellcheck source=/dev/null
. "$PATINA_GUEST/cases/$1.sh"
end
