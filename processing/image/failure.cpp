// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/failure.h"

#include <cstdio>
#include <cstdlib>

namespace patina {

void failCheck(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "patina: our bug, please report: %s is false at %s:%d\n", condition, file,
               line);
  std::abort();
}

}  // namespace patina
