// SPDX-License-Identifier: GPL-3.0-or-later
// Is this file the picture that was asked for? Every frame, before it is acknowledged.
// Each file is decoded once; what the light gate needs is measured on the way. Raw files are judged
// on the mosaic, without interpolation.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calibration/light/content.h"
#include "calibration/light/light_statistics.h"
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
  int bits = 0;
  double saturated_fraction = 0;
};
// A file as it came, good or not: all that is needed to know it again.
struct SeenFile {
  int file_index = 0;
  Sha256 sha256;
  bool lit = false;
};
struct ShotCheck {
  FrameFault fault = FrameFault::kNone;
  std::string detail;                // one line for a person
  std::vector<CheckedFrame> frames;  // in file_index order; borrowed from the shot
  std::vector<SeenFile> came;        // the shot's files, also those of a shot that is refused
  std::vector<std::string> remarks;  // "duplicate file dropped", "late picture of shot 41"
  std::optional<calibration::PatchLevel> patch;  // of the first file
  std::optional<calibration::TileLevels> tiles;  // likewise, where there is a patch
  double saturated_fraction = 0;                 // of the first file
  bool all_equal = false;  // black or flat: a verdict of the light, never a refusal
};

// Of a file that was good once. Throws ProcessingError, CalibrationError.
calibration::TileLevels tilesOf(std::span<const std::byte> file, RectPx patch);

// The contract of one camera, and what its last picture was. One object a camera; no locks.
class FrameCheck {
 public:
  FrameCheck(const devices::CameraCaps& caps, std::optional<RectPx> patch);

  // `lit`: some lamp was on. Without light a developed file may repeat byte for byte, and a raw one
  // whose samples are all equal; any other raw file has noise and never does.
  ShotCheck check(const std::vector<devices::RawFrame>& frames, const devices::Ticket& ticket,
                  bool lit) const;
  // What came is what a stale picture would repeat, also when nobody waited for it any more, it was
  // refused, or the light or the disk kept it from being acknowledged. Known are the last picture
  // that was good and what was refused since.
  void remember(const ShotCheck& seen);
  // The last picture of an earlier process, for remember().
  void recall(std::vector<SeenFile> files) { known_ = std::move(files); }

 private:
  void checkFile(const devices::RawFrame& frame, const SeenFile& seen, ShotCheck& out) const;
  // What the contract says of a file, or the first good shot where it does not.
  SizePx sizeOf(const devices::RawFrame& frame) const;
  int bitsOf(const devices::RawFrame& frame) const;
  const SeenFile* knownAs(const SeenFile& seen) const;
  void refuse(ShotCheck& out, FrameFault fault, std::string detail) const;

  const devices::CameraCaps& caps_;
  std::optional<RectPx> patch_;
  std::vector<SeenFile> known_;  // oldest first
  struct Learned {
    SizePx size;
    int bits = 0;
  };
  std::map<int, Learned> learned_;  // by file_index
};

}  // namespace patina::capture
