// SPDX-License-Identifier: GPL-3.0-or-later
// The camera's body: shutter, settings, card, and the events it has to say. It behaves; who makes
// it misbehave is dslr.cpp.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "devices/twin/dslr/camera_settings.h"
#include "devices/twin/dslr/card.h"
#include "devices/twin/dslr/ptp_exchange.h"
#include "devices/twin/dslr/truth.h"
#include "devices/twin/picture_maker.h"

namespace patina::devices::twin::dslr {

struct DslrOptions {
  std::string camera{};  // its id in the rig; empty: the first
  std::string model = "Patina DSLR", serial = "1001";
  Nanoseconds save = std::chrono::milliseconds(20);  // from the exposure's end to the card
  Nanoseconds clock_off{};                           // the camera's clock minus the true one
  std::int64_t card_bytes = 32'000'000'000, memory_bytes = 256'000'000;
  std::uint64_t shutter_count = 0;  // before its first picture here
};

// What a capture does wrong.
struct CaptureTrouble {
  bool stale = false, full = false;
  int times = 1;  // each of its events is said
  Nanoseconds late{};
};

// Thread-bound: its camera's lock guards it.
class Body {
 public:
  Body(std::shared_ptr<World> world, DslrOptions options);

  CameraSettings settings;
  Card card;
  Truth truth;
  bool session_open = false;

  const DslrOptions& options() const { return options_; }
  Clock& clock() const { return world_->clock(); }
  SizePx pictureSize() const { return maker_.layout().size; }
  UtcTime cameraTime() const;
  // "20240501T120000.0", as clients read and set it; false: no time.
  void refreshTime();
  bool setTime(const std::string& text);

  // The shutter opens: kOk, kDeviceBusy, kStoreFull.
  Answer capture(std::uint32_t transaction, const CaptureTrouble& trouble);
  void remove(std::uint32_t handle);  // a file that is there
  void say(const PtpEvent& event, Nanoseconds late = {});
  void finishDue();                    // pictures whose time has come
  std::vector<PtpEvent> takeEvents();  // whose time has come; without a session they are lost
  std::optional<MonoTime> nextDue() const;
  void losePower();

 private:
  struct OpenShot {
    ShotLight light;
    TruePicture picture;
    std::uint32_t transaction = 0, store = kCardStore;
    std::int64_t compression = kJpegOnly;
    MonoTime done;
    CaptureTrouble trouble;
  };
  struct PlannedEvent {
    PtpEvent event;
    MonoTime due;
  };
  void chooseExposure();  // what automatic modes do to the settings
  std::vector<CardObject> develop(const OpenShot& shot);
  void store(OpenShot& shot, std::vector<CardObject> files);

  std::shared_ptr<World> world_;
  DslrOptions options_;
  std::uint64_t seed_;
  PictureMaker maker_;
  SrgbDeveloper developer_;
  std::int64_t bytes_a_picture_;  // more than one takes: what must be free
  std::optional<OpenShot> shot_;
  std::vector<CardObject> previous_;  // files of the last picture
  std::vector<PlannedEvent> events_;  // in the order they were said
};

}  // namespace patina::devices::twin::dslr
