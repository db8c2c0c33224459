# SPDX-License-Identifier: GPL-3.0-or-later
# The backend v4l2 on vivid, the kernel's virtual camera, which breaks on order.
need_program v4l2_real_node_test
modprobe vivid n_devs=1 node_types=0x1
check "vivid makes a node" soon test -e /dev/video0
export PATINA_V4L2_DEVICE=/dev/video0
gtests v4l2_real_node_test "*"
