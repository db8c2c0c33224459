// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/config_rect.h"

#include <cmath>

namespace patina::devices {

RectPx takeRect(ConfigTable& table, const std::string& key) {
  const auto numbers = table.takeNumbers(key, 4);
  for (std::size_t i = 0; i < 4; ++i)
    if (numbers[i] != std::floor(numbers[i]) || numbers[i] < (i < 2 ? 0 : 1) ||
        numbers[i] > kSideMaxPx)
      table.reject(key, "must be [x, y, width, height] in whole pixels (0 to 65535)");
  return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1]), static_cast<int>(numbers[2]),
          static_cast<int>(numbers[3])};
}

}  // namespace patina::devices
