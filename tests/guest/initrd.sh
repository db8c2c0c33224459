#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# initrd.sh CACHE   CACHE/initrd.gz: busybox, the modules that mount the host's root over 9p, and `init`.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cache=$1
release=$(cat "$cache/kernel/release")
folder=$cache/kernel/modules/$release
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
mkdir -p "$tree"/{bin,proc,sys,dev,modules,host,over,root}
cp /bin/busybox "$tree/bin/busybox"
cp "$here/init" "$tree/init"

# A line of modules.dep names a module and what it needs, the deepest need last.
count=0
declare -A seen
for name in virtio_pci virtio_console 9pnet_virtio 9p overlay; do
  line=$(grep -E "/$name\.ko:" "$folder/modules.dep") || continue  # built in
  read -ra files <<<"${line/:/}"
  for ((i = ${#files[@]} - 1; i >= 0; i--)); do
    [ -n "${seen[${files[i]}]:-}" ] && continue
    seen[${files[i]}]=1
    cp "$folder/${files[i]}" "$tree/modules/$(printf %02d $count)-$(basename "${files[i]}")"
    count=$((count + 1))
  done
done
(cd "$tree" && find . | cpio -o -H newc --quiet | gzip -1) >"$cache/initrd.gz.new"
mv "$cache/initrd.gz.new" "$cache/initrd.gz"
