#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# boot.sh CACHE BUILD CASE   boots the kernel of CACHE under software emulation and runs cases/CASE.sh in it with the
# host's own files, read-only, and the programs of BUILD. Exits as inside.sh does.
#
# Never by KVM: inside a virtual machine /dev/kvm may open and the guest yet hang at its first instruction.
set -euo pipefail
tests=$(cd "$(dirname "$0")" && pwd)
cache=$(cd "$1" && pwd)
build=$(cd "$2" && pwd)
case=$3
console=$(mktemp)
trap 'rm -f "$console"' EXIT

# What costs an emulated processor most: guards against leaks between programs, and waiting for a timer interrupt that
# a busy machine may not deliver in time.
fast="mitigations=off tsc=reliable no_timer_check rcupdate.rcu_expedited=1"
words="patina.cache=$cache patina.build=$build patina.tests=$tests patina.case=$case"
timeout --foreground 1700 nice -n 10 qemu-system-x86_64 -M q35 -accel tcg -cpu max -m 1024 -smp 1 \
  -nodefaults -no-user-config -nographic -no-reboot -serial stdio \
  -kernel "$cache/kernel/vmlinux" -initrd "$cache/initrd.gz" \
  -append "console=ttyS0 quiet loglevel=${GUEST_LOGLEVEL:-3} panic=-1 $fast $words" \
  -virtfs local,path=/,mount_tag=host,security_model=none,readonly=on,multidevs=remap </dev/null |
  sed -u 's|\r||' | tee "$console" || echo "guest: QEMU ended with an error or after 1700 s"

result=$(sed -n 's/^guest: result \([0-9]*\)$/\1/p' "$console")
[ -n "$result" ] || { echo "FAIL $case: the guest never came to its end"; exit 1; }
exit "$result"
