// SPDX-License-Identifier: GPL-3.0-or-later
// libgphoto2 2.5.30 closes descriptor 0 at the end of every PTP/IP session. A driver's own process
// can bear that; in a test's, which has the camera's server in other threads, one of their sockets
// may have got that number a moment before. Here nobody's close(0) does anything.
#include <dlfcn.h>

extern "C" int close(int fd) {
  using Close = int (*)(int);
  static const auto kNext = reinterpret_cast<Close>(dlsym(RTLD_NEXT, "close"));
  return fd == 0 ? 0 : kNext(fd);
}
