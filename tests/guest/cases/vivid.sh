# SPDX-License-Identifier: GPL-3.0-or-later
# On vivid, the kernel's virtual camera, which breaks on order: a plan of the program itself, then the backend v4l2.
need_program v4l2_real_node_test
modprobe vivid n_devs=1 node_types=0x1
check "vivid makes a node" soon test -e /dev/video0

# answer VERB...: the program's, with what it printed kept for told and captured.
answer() { "$PATINA_BUILD/patina" "$@" --archive /tmp/bars --json >/run/answer; }
told() { grep -F "$1" /run/answer || { cat /run/answer; return 1; }; }
check "the program starts" "$PATINA_BUILD/patina" --version
check "a plan of 100 steps runs to its end" answer capture "$PATINA_GUEST/vivid/plan.toml"
check "with a row for each of them" told '"end":"finished",'
captured=$(sed -n 's/.*"steps":100,"captured":\([0-9]*\),.*/\1/p' /run/answer)
# The first of them may fall due while the driver's process is still being read over 9p.
check "90 of them at least were captured, ${captured:-none} were" test "${captured:-0}" -ge 90
check "its archive is whole" answer archive verify
check "with a picture for each captured step" told "\"frames\":$captured,"

export PATINA_V4L2_DEVICE=/dev/video0
gtests v4l2_real_node_test "*"
