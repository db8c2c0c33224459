# SPDX-License-Identifier: GPL-3.0-or-later
# The backend usb on a HID relay board: a gadget of this kernel behind its own host stack.
# Without udevd nobody else loads hid_generic, which makes the hidraw node.
need_program guest_relay_test
modprobe -a dummy_hcd libcomposite usb_f_fs usbhid hid_generic
mount -t configfs configfs /sys/kernel/config 2>/dev/null
gtests guest_relay_test '*'
