# SPDX-License-Identifier: GPL-3.0-or-later
# The backend gphoto2 and libgphoto2 on the virtual DSLR: a USB gadget of this kernel behind its own host stack.
need_program guest_gphoto_test
modprobe -a dummy_hcd libcomposite usb_f_fs
mount -t configfs configfs /sys/kernel/config 2>/dev/null
gtests guest_gphoto_test '*'
