# SPDX-License-Identifier: GPL-3.0-or-later
# The backend gpio on gpio-sim: a chip with eight lines, whose far ends the kernel shows in sysfs.
need_program guest_gpio_test
modprobe configfs
mount -t configfs configfs /sys/kernel/config 2>/dev/null
own_module gpio-sim
sim=/sys/kernel/config/gpio-sim/patina
mkdir -p "$sim/bank0"
echo 8 >"$sim/bank0/num_lines"
echo patina-lamps >"$sim/bank0/label"
check "gpio-sim makes a chip" sh -c "echo 1 >$sim/live"
PATINA_GPIO_SIM=$(echo /sys/devices/platform/"$(cat "$sim/dev_name")"/gpiochip*)
export PATINA_GPIO_SIM
gtests guest_gpio_test '*'
