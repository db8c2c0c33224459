// SPDX-License-Identifier: GPL-3.0-or-later
// A shutter line apart from the download: fires several bodies together.
#pragma once

#include <string>

#include "devices/clock.h"
#include "devices/result.h"

namespace patina::devices {

class Trigger {  // Thread-bound.
 public:
  virtual ~Trigger() = default;
  virtual const std::string& id() const = 0;
  virtual Result<MonoTime> fire() = 0;  // when the line went active
  virtual Result<void> recover() = 0;
};

}  // namespace patina::devices
