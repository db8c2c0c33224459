// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>

#include "devices/clock.h"
#include "processing/image/units.h"

namespace patina::doctor {

struct CommitLatency {
  Nanoseconds median{}, worst{};
};

// From armShot() to the end of acknowledge() of `shots` frames of noise, by the real protocol, in
// an archive below `folder` that is removed again. Throws db::ArchiveError.
CommitLatency probeCommits(const std::filesystem::path& folder, devices::Clock& clock,
                           int shots = 24, std::int64_t frame_bytes = 1'000'000);

}  // namespace patina::doctor
