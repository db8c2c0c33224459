// SPDX-License-Identifier: GPL-3.0-or-later
// A camera: one shutter, one picture (one or more files) a shot.
//
// States: Closed -> Ready -> Armed -> Ready; any -> Lost. Start-up is recover(Rung::kReopen); only
// recover() leaves Lost. Calls in a wrong state answer kRefused (kLost in Lost) and change nothing.
//   Closed: recover. Ready: configure, trigger, poll, release, recover. Armed: collect, recover.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/result.h"
#include "processing/image/picture_file.h"

namespace patina::devices {

struct Exposure {
  Nanoseconds time{10'000'000};
  Iso iso{100};
  FNumber f_number{8};
  bool operator==(const Exposure&) const = default;
};

struct CameraCaps {
  std::string id;  // of the rig file
  std::string model, serial;
  SizePx size;   // of a picture; 0x0: each file's own, learned from the first good shot
  int bits = 8;  // of its samples; 0: learned too
  std::vector<std::string> extensions;  // of the files of one shot, in file_index order
  Nanoseconds exposure_min{}, exposure_max{};
  Nanoseconds cycle{};  // shortest time from trigger to the next trigger, readout included
  std::int64_t bytes_a_shot = 0;  // estimate, all files
  bool has_shutter = false;       // counts mechanical actuations
};

// What the hardware says it did, read back; never silently adjusted. What a camera has no control
// for (a webcam's ISO and f-number) comes back as it was asked for.
struct Applied {
  Exposure exposure;
};

// `key` names this attempt for ever (idempotency): run + step + camera + light + exposure +
// attempt.
struct ShotRequest {
  std::string key;
  std::uint64_t sequence = 0;  // rises with every attempt of this camera
};
struct Ticket {
  std::string key;
  std::uint64_t sequence = 0;
  UtcTime began_utc;
  MonoTime began_mono;
};

// What the process of a driver made of a file's bytes (devices/host).
struct Seen {
  std::string refused;  // why they are no picture; empty: they are one
  SizePx size;
  int bits = 0;     // of its samples
  Bytes thumbnail;  // JPEG, its longer side 256 px at most
};

struct RawFrame {
  int file_index = 0;  // RAW+JPEG: two files of one shot
  std::string ext;     // "dng" "jpg", no dot
  Bytes bytes;
  std::uint64_t sequence = 0;  // the camera's own count, when it has one; of THIS picture
  std::optional<std::int64_t> declared_bytes;  // what the camera said the file's length is
  UtcTime utc;                                 // mid exposure, host time
  MonoTime mono;
  std::string card_handle;  // for release(); empty when there is no card copy
  std::optional<Seen> seen;
};

enum class Rung { kRetry, kDrain, kReopen, kReset, kPowerCycle };  // of the recovery ladder
const char* name(Rung rung);

struct CameraEvent {
  std::string what;
};

// Thread-bound: its own worker only. The destructor closes and never throws. Every call returns
// within its deadline or, without one, within caps().cycle + 10 s.
class Camera {
 public:
  virtual ~Camera() = default;
  virtual const CameraCaps& caps() const = 0;  // known before asking; any state
  virtual Result<Applied> configure(const Exposure& exposure) = 0;
  // Returns once the shutter was told, so that several bodies fire together.
  virtual Result<Ticket> trigger(const ShotRequest& request) = 0;
  // kTimeout: unknown, recover() next. Frames belong to this ticket or the answer is an error;
  // a driver that cannot tell passes on `sequence`, and the session checks.
  virtual Result<std::vector<RawFrame>> collect(const Ticket& ticket, MonoTime deadline) = 0;
  // The card's copy, after the acknowledgement; `frame` comes without its bytes.
  virtual Result<void> release(const RawFrame& frame) = 0;
  virtual Result<std::vector<CameraEvent>> poll() = 0;  // drains events, keeps it awake
  virtual Result<void> recover(Rung rung) = 0;          // idempotent
};

}  // namespace patina::devices
