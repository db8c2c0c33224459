// SPDX-License-Identifier: GPL-3.0-or-later
// What really happened in the camera: what tests hold a driver against.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/twin/dslr/misbehaviour.h"
#include "processing/image/sha256.h"

namespace patina::devices::twin::dslr {

struct TrueFile {
  std::uint32_t handle = 0, store = 0;
  std::string name;
  bool raw = false;
  std::size_t bytes = 0;
  Sha256 hash;
  std::optional<UtcTime> deleted_utc;  // by a client
  bool lost = false;                   // it was in memory when the power went
};

struct TruePicture {
  std::uint64_t count = 0;  // of the shutter: 1 is its first actuation
  UtcTime begin_utc;        // of the exposure, by the true clock
  MonoTime begin_mono;
  UtcTime camera_time;         // the same by the camera's own clock: what its files say
  Exposure exposure;           // what it was taken with
  std::vector<double> levels;  // of every lamp of the rig, over the exposure
  std::vector<TrueFile> files;
  bool stale = false;  // no exposure: these files are copies of the picture `count`
};

struct TrueFault {
  UtcTime utc;
  DslrFault fault;
  Operation operation{};  // that it hit; 0: none
};

struct Truth {
  std::vector<TruePicture> pictures;
  std::vector<TrueFault> faults;
  std::uint64_t shutter_count = 0, power_losses = 0, sessions = 0;
};

}  // namespace patina::devices::twin::dslr
