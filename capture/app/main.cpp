// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstdio>

int main() {
  std::fputs("patina: no verb is built in yet\n", stderr);
  return 64;
}
