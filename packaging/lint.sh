#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# lint.sh [BASE | all]   clang-format on every source, clang-tidy on the sources changed since BASE (all: on each).
# Without BASE: since the fork from origin's main branch, or, where HEAD is that branch (or there is none, as in a fresh
# clone of one branch), the last 20 commits. Needs a configured build/ (compile_commands.json).
cd "$(dirname "$0")/.." || exit 70
packaging/install-packages.sh lint || exit $?

rooms='processing calibration devices db capture tests'
empty_tree=$(git hash-object -t tree /dev/null)

choose_base() {
  for branch in origin/HEAD origin/main main; do
    fork=$(git merge-base "$branch" HEAD 2>/dev/null) || continue
    [ "$fork" != "$(git rev-parse HEAD)" ] && echo "$fork" && return
  done
  # A shallow or young history has fewer: then everything counts as changed.
  git rev-parse -q --verify 'HEAD~20^{commit}' 2>/dev/null || echo "$empty_tree"
}

case $1 in
  '') base=$(choose_base) ;;
  all) base=$empty_tree ;;
  *) base=$1 ;;
esac

status=0
git ls-files -z -- '*.h' '*.cpp' |
  xargs -0 -r clang-format --dry-run -Werror || status=1

# A changed header is looked at through the .cpp of its name. Files that are not built here have no compile command.
changed=$(
  { git diff --name-only --diff-filter=d "$base" -- $rooms; git ls-files -o --exclude-standard -- $rooms; } |
    sed -n 's/\.\(h\|cpp\)$/.cpp/p' | sort -u | while read -r file; do
      [ -f "$file" ] && grep -q "\"file\": \"$PWD/$file\"" build/compile_commands.json && echo "$file"
    done
)
echo "lint: clang-tidy on $(printf '%s' "$changed" | grep -c .) files changed since $(git rev-parse --short "$base")"
if [ -n "$changed" ]; then
  # Findings go to stdout; stderr only counts the warnings it suppressed in system headers.
  printf '%s\n' "$changed" | xargs -P "$(nproc)" -n 1 clang-tidy -p build --quiet 2>build/clang-tidy.log || {
    status=1
    tail -n 5 build/clang-tidy.log
  }
fi
[ $status -eq 0 ] && echo 'lint: clean'
exit $status
