// SPDX-License-Identifier: GPL-3.0-or-later
// A small twin rig for tests: one camera, one or two lamps, on a virtual clock.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "devices/twin/twin.h"

namespace patina::devices::twin {

// camera cam0, lights key and fill (key straight above), sensors of every kind.
inline RigSpec benchRig(const std::string& specimen, const std::string& size) {
  return parseRig(
      "name = 'bench'\n"
      "[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [0, 0, 500]\n"
      "[[light]]\nid = 'fill'\nbackend = 'twin'\nposition_mm = [300, 100, 400]\n"
      "[[sensor]]\nid = 'lux'\nbackend = 'twin'\nquantity = 'illuminance'\n"
      "[[sensor]]\nid = 'air'\nbackend = 'twin'\nquantity = 'temperature'\n"
      "[[sensor]]\nid = 'wet'\nbackend = 'twin'\nquantity = 'humidity'\n"
      "[twin]\nspecimen = '" +
          specimen + "'\nsize = '" + size + "'\n",
      "rig.toml");
}

// A rig that is ready to shoot.
class Bench {
 public:
  explicit Bench(const RigSpec& spec, const TwinOptions& options = {}, Nanoseconds late = {})
      : clock(options.start_utc + late), rig(makeTwinRig(spec, options, clock)) {
    EXPECT_TRUE(camera().recover(Rung::kReopen));
  }
  Camera& camera() { return *rig.cameras.at(0); }
  void light(std::size_t lamp, double level) { EXPECT_TRUE(rig.lights.at(lamp)->set(level)); }
  void advance(Nanoseconds d) { clock.advance(d); }

  std::vector<RawFrame> shoot() {
    const ShotRequest request{"shot" + std::to_string(++shots_), shots_};
    const auto ticket = camera().trigger(request);
    EXPECT_TRUE(ticket);
    auto frames = camera().collect(*ticket, clock.mono() + std::chrono::seconds(60));
    EXPECT_TRUE(frames);
    return frames ? std::move(*frames) : std::vector<RawFrame>{};
  }

  VirtualClock clock;
  Rig rig;

 private:
  std::uint64_t shots_ = 0;
};

}  // namespace patina::devices::twin
