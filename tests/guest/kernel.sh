#!/bin/bash
# SPDX-License-Identifier: GPL-3.0-or-later
# kernel.sh CACHE   Debian's present kernel, unpacked and never installed: CACHE/kernel (vmlinux, modules/) and
# CACHE/initrd.gz. What Debian leaves out (vimc, gpio-sim) is built from its own source into CACHE/modules; where that
# fails, CACHE/modules/NAME.why says why and the cases that need it are skipped. A second run finds everything there.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
mkdir -p "$1"
cache=$(cd "$1" && pwd)
modules=$cache/modules
mkdir -p "$cache/debs" "$modules"

# The package that a metapackage stands for today: "linux-image-amd64 linux-image" -> linux-image-6.1.0-56-amd64
resolve() { apt-cache depends "$1" 2>/dev/null | sed -n "s/^ *Depends: \($2-[0-9].*\)/\1/p" | sed -n 1p; }

# fetch PACKAGE FOLDER: unpacks it below FOLDER.
fetch() {
  (cd "$cache/debs" && apt-get download -q "$1" >&2)
  mkdir -p "$2"
  dpkg-deb -x "$cache"/debs/"$1"_*.deb "$2"
}

image=$(resolve linux-image-amd64 linux-image)
[ -n "$image" ] || { echo "apt knows no linux-image-amd64: run 'apt-get update' first" >&2; exit 69; }
release=${image#linux-image-}

fetch_image() {
  rm -rf "$cache/image" "$cache/headers" "$modules"
  mkdir "$modules"
  fetch "$image" "$cache/image"
  depmod -b "$cache/image" "$release"
  rm -rf "$cache/kernel"
  mkdir "$cache/kernel"
  ln -s "../image/lib/modules" "$cache/kernel/modules"
  # Unpacked here it need not be unpacked by the emulated processor: that saves half of the boot.
  local packed=$cache/image/boot/vmlinuz-$release offset
  offset=$(LC_ALL=C grep -obUaP -m1 '\xfd7zXZ\x00' "$packed" | LC_ALL=C cut -d: -f1 | sed -n 1p)
  if ! xz -dc --single-stream < <(tail -c "+$((offset + 1))" "$packed") >"$cache/kernel/vmlinux"; then
    ln -sf "../image/boot/vmlinuz-$release" "$cache/kernel/vmlinux"
  fi
  echo "$release" >"$cache/kernel/release"
}

# sources: the few files of linux-source that the modules need, out of 140 MB.
fetch_sources() {
  local package
  [ -e "$modules/kernel/irq/irq_sim.c" ] && return
  package=$(resolve linux-source linux-source)
  (cd "$cache/debs" && apt-get download -q "$package" >&2)
  dpkg-deb --fsys-tarfile "$cache"/debs/"$package"_*.deb | tar -xO "./usr/src/$package.tar.xz" | xz -dc |
    tar -x -C "$modules" --strip-components=1 "$package/drivers/media/test-drivers/vimc" \
      "$package/drivers/gpio/gpio-sim.c" "$package/drivers/gpio/gpiolib.h" "$package/kernel/irq/irq_sim.c"
}

fetch_headers() {
  [ -e "$cache/headers/usr/src/linux-headers-$release/Makefile" ] && return
  local headers=linux-headers-$release common=linux-headers-${release%-amd64}-common
  fetch "$headers" "$cache/headers"
  fetch "$common" "$cache/headers"
  fetch "$(apt-cache depends "$headers" | sed -n 's/^ *Depends: \(linux-kbuild-.*\)/\1/p' | sed -n 1p)" "$cache/headers"
  echo "include $cache/headers/usr/src/$common/Makefile" >"$cache/headers/usr/src/$headers/Makefile"
}

kbuild() { make -s -C "$cache/headers/usr/src/linux-headers-$release" "M=$1" "${@:2}" modules; }

build_vimc() {
  kbuild "$modules/drivers/media/test-drivers/vimc" CONFIG_VIDEO_VIMC=m &&
    cp "$modules/drivers/media/test-drivers/vimc/vimc.ko" "$modules/"
}

# gpio-sim needs the simulated interrupts, which Debian's kernel leaves out too: both in one module.
build_gpio_sim() {
  local folder=$modules/gpio
  mkdir -p "$folder"
  cp "$modules/drivers/gpio/gpio-sim.c" "$folder/gpio-sim-core.c"
  cp "$modules/drivers/gpio/gpiolib.h" "$folder/"
  sed -e '/^EXPORT_SYMBOL/d' -e 's/handle_simple_irq(irq_to_desc(\(\w*\)))/generic_handle_irq(\1)/' \
    "$modules/kernel/irq/irq_sim.c" >"$folder/irq_sim.c"
  printf 'obj-m := gpio-sim.o\ngpio-sim-y := gpio-sim-core.o irq_sim.o\n' >"$folder/Makefile"
  kbuild "$folder" && cp "$folder/gpio-sim.ko" "$modules/"
}

# build NAME FUNCTION
build() {
  [ -e "$modules/$1.ko" ] && return
  if ! "$2" >"$modules/$1.log" 2>&1; then
    echo "$1 could not be built for $release: $(grep -m1 'rror' "$modules/$1.log")" | tee "$modules/$1.why" >&2
  fi
}

if [ "$(cat "$cache/kernel/release" 2>/dev/null)" != "$release" ]; then
  echo "Fetching Debian's kernel $release" >&2
  fetch_image
fi
if [ ! -e "$modules/vimc.ko" ] || [ ! -e "$modules/gpio-sim.ko" ]; then
  rm -f "$modules"/*.why
  echo "Building vimc and gpio-sim from Debian's kernel source (140 MB to fetch)" >&2
  if fetch_headers && fetch_sources; then
    build vimc build_vimc
    build gpio-sim build_gpio_sim
  else
    for name in vimc gpio-sim; do echo "no kernel headers or source from apt" >"$modules/$name.why"; done
  fi
fi
rm -rf "$cache/debs"
"$here/initrd.sh" "$cache"
echo "kernel $release"
