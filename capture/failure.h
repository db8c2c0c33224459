// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "processing/image/failure.h"

namespace patina::capture {

class CaptureError : public Failure {
 public:
  using Failure::Failure;
};

}  // namespace patina::capture
