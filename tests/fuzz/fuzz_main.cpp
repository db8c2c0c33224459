// SPDX-License-Identifier: GPL-3.0-or-later
// libFuzzer's door to one target; PATINA_FUZZ_TARGET is its function.
#include <cstdint>

#include "tests/fuzz/targets.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  patina::testing::PATINA_FUZZ_TARGET(std::as_bytes(std::span(data, size)));
  return 0;
}
