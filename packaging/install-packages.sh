#!/bin/sh
# SPDX-License-Identifier: GPL-3.0-or-later
# install-packages.sh [lint | fuzz | guest]   installs what is missing of Debian 12; silent when all is there. Never asks.
# docs/dependencies.md says why each package is here; tests/house compares the two lists.
packages='
  ccache cmake e2fsprogs g++ git gphoto2 libavcodec-dev libavformat-dev libavutil-dev libbenchmark-dev libcamera-dev libcli11-dev
  libcurl4-openssl-dev libeigen3-dev libembree-dev libexiv2-dev libexpected-dev libfftw3-dev libfuse3-dev libgmock-dev libgphoto2-dev
  libgpiod-dev libgtest-dev
  libhdf5-dev libjpeg-dev liblapacke-dev libmicrohttpd-dev libmosquitto-dev libmuparser-dev libopenblas-dev
  libopencv-calib3d-dev libopencv-contrib-dev libopencv-core-dev libopencv-features2d-dev libopencv-imgproc-dev
  libopencv-photo-dev libopencv-video-dev libopenexr-dev libpng-dev libraw-dev libspdlog-dev libsqlite3-dev
  libssl-dev libswscale-dev libsystemd-dev libtbb-dev libtiff-dev libtinygltf-dev libtinyobjloader-dev libtomlplusplus-dev
  libumockdev-dev libusb-1.0-0-dev make ninja-build nlohmann-json3-dev
  python3-h5py umockdev xfsprogs'
lint_packages='clang-format clang-tidy'
fuzz_packages='clang-14 libclang-rt-14-dev'
guest_packages='busybox-static cpio kmod libcamera-ipa libelf1 qemu-system-x86 udev xz-utils'

[ "$1" = lint ] && packages="$packages $lint_packages"
[ "$1" = fuzz ] && packages="$packages $fuzz_packages"
[ "$1" = guest ] && packages="$packages $guest_packages"

# One query for all; "install ok installed" or "hold ok installed" is there, whatever the architecture.
present=" $(dpkg-query -W -f '${Package}=${db:Status-Status} ' $packages 2>/dev/null)"
missing=''
for package in $packages; do
  case $present in
    *" $package=installed "*) ;;
    *) missing="$missing $package" ;;
  esac
done
[ -z "$missing" ] && exit 0

if [ "$(id -u)" -ne 0 ]; then
  echo "Packages are missing, and only root may install them. Run this, then try again:" >&2
  echo "  sudo apt-get update && sudo apt-get install -y --no-install-recommends$missing" >&2
  exit 69
fi

export DEBIAN_FRONTEND=noninteractive
install_missing() {
  apt-get install -y -q --no-install-recommends $missing </dev/null
}
echo "Installing:$missing" >&2
if ! ls /var/lib/apt/lists/*Packages* >/dev/null 2>&1; then
  apt-get update -q </dev/null || exit 69
fi
# Lists that are there may be stale: one fresh look before giving up.
install_missing || { apt-get update -q </dev/null && install_missing; } || {
  echo "apt-get could not install:$missing" >&2
  exit 69
}
