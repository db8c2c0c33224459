# SPDX-License-Identifier: GPL-3.0-or-later
# The backend libcamera on vimc, the kernel's virtual media controller: real media graph, real V4L2, real hotplug.
# vimc has no control of the exposure: that part is held by the unit tests.
need_program libcamera_test
modprobe -a v4l2-tpg videobuf2-v4l2 videobuf2-vmalloc videobuf2-dma-contig v4l2-async
# Without a running udevd libcamera sees no device.
/lib/systemd/systemd-udevd --daemon 2>/dev/null
own_module vimc
udevadm trigger 2>/dev/null
check "vimc makes a media device" soon test -e /dev/media0
export PATINA_LIBCAMERA_CAMERA=any PATINA_LIBCAMERA_UNPLUG="/sys/bus/platform/drivers/vimc vimc.0"
gtests libcamera_test 'AttachedCamera.*:UnpluggableCamera.*'
