// SPDX-License-Identifier: GPL-3.0-or-later
// What the camera does when a client asks.
#pragma once

#include "devices/twin/dslr/body.h"

namespace patina::devices::twin::dslr {

PtpReply execute(Body& body, const PtpCommand& command, const CaptureTrouble& trouble);

}  // namespace patina::devices::twin::dslr
