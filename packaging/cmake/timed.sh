#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# timed.sh LOG NAME COMMAND...   runs COMMAND and appends "user_seconds NAME" to LOG.
# NAME "-" stands for the file after -c (a compilation); a command without -c is not logged then.
log=$1 name=$2
shift 2
if [ "$name" = - ]; then
  name='' before=''
  for argument; do
    [ "$before" = -c ] && name=$argument
    before=$argument
  done
fi
exec 3>&1 4>&2
user=$(TIMEFORMAT=%U; { time "$@" >&3 2>&4 3>&- 4>&-; } 2>&1)
status=$?
[ -n "$name" ] && echo "$user $name" >>"$log"
exit $status
