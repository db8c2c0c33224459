#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# timed.sh LOG NAME COMMAND...   runs COMMAND and appends "user_seconds NAME" to LOG.
# NAME "-" stands for the file after -c (a compilation), else the one after -o (a link).
log=$1 name=$2
shift 2
if [ "$name" = - ]; then
  name='' output='' before=''
  for argument; do
    case $before in
      -c) name=$argument ;;
      -o) output=$argument ;;
    esac
    before=$argument
  done
  name=${name:-$output}
fi
exec 3>&1 4>&2
user=$(TIMEFORMAT=%U; { time "$@" >&3 2>&4 3>&- 4>&-; } 2>&1)
status=$?
[ -n "$name" ] && echo "$user $name" >>"$log"
exit $status
