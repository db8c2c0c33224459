// SPDX-License-Identifier: GPL-3.0-or-later
// Is this file the picture that was asked for? Every frame, before it is acknowledged.
// Each file is decoded once; what the light gate needs is measured on the way. Raw files are judged
// on the mosaic, without interpolation.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/light_statistics.h"
#include "devices/camera.h"
#include "processing/image/sha256.h"

namespace patina::capture {

enum class FrameFault {
  kNone,
  kMissingFile,   // RAW+JPEG came without one of the two
  kLength,        // fewer or more bytes than the camera declared
  kDecode,        // not a picture, truncated, beyond the limits
  kWrongSize,     // of another size or depth than the contract
  kDuplicate,     // the previous picture of this camera, returned as new
  kStaleSequence  // a picture of another shot
};
const char* name(FrameFault fault);

struct CheckedFrame {
  const devices::RawFrame* frame = nullptr;
  Sha256 sha256;
  SizePx size;
  double saturated_fraction = 0;
};
struct ShotCheck {
  FrameFault fault = FrameFault::kNone;
  std::string detail;                // one line for a person
  std::vector<CheckedFrame> frames;  // in file_index order; borrowed from the shot
  std::vector<std::string> remarks;  // "duplicate file dropped", "late picture of shot 41"
  std::optional<calibration::PatchLevel> patch;  // of the first file
  double saturated_fraction = 0;                 // of the first file
  bool all_equal = false;  // black or flat: a verdict of the light, never a refusal
  bool lit = false;        // some lamp was on
};

// The contract of one camera, and what its last picture was. One object a camera.
class FrameCheck {
 public:
  FrameCheck(const devices::CameraCaps& caps, std::optional<RectPx> patch);

  // `lit`: some lamp was on. Without light a developed file may repeat byte for byte, and a raw one
  // whose samples are all equal; any other raw file has noise and never does.
  ShotCheck check(const std::vector<devices::RawFrame>& frames, const devices::Ticket& ticket,
                  bool lit) const;
  // The hashes of what came are what a stale picture would repeat, also when the light or the disk
  // kept the shot from being acknowledged.
  void remember(const ShotCheck& seen);

 private:
  void checkFile(const devices::RawFrame& frame, bool lit, ShotCheck& out) const;
  void refuse(ShotCheck& out, FrameFault fault, std::string detail) const;

  const devices::CameraCaps& caps_;
  std::optional<RectPx> patch_;
  struct Last {
    Sha256 sha256;
    bool lit = false;
  };
  std::map<int, Last> last_;  // by file_index
};

}  // namespace patina::capture
