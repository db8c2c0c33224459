// SPDX-License-Identifier: GPL-3.0-or-later
// The lamps of a world at the end of an Art-Net cable: they hear OpDmx packets over UDP.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "devices/twin/world.h"

namespace patina::devices::twin::dslr {

// Where a lamp listens.
struct DmxAddress {
  int universe = 0, channel = 1;  // channels from 1
};
// Settings `universe` and `channel` of each lamp in the rig; without, lamp i hears channel i from 1
// of universe 0. ConfigError for one that cannot be.
std::vector<DmxAddress> dmxAddresses(const RigSpec& rig);

// Serves from a thread of its own. Level = slot / 255. A lamp keeps what it last heard.
class ArtNetLamps {
 public:
  // Port 0: any free one. Failure(kUsage, kUnavailable) when it cannot listen there.
  ArtNetLamps(std::shared_ptr<World> world, std::vector<DmxAddress> lamps,
              const std::string& address = "127.0.0.1", int port = 0);
  ~ArtNetLamps();
  ArtNetLamps(const ArtNetLamps&) = delete;
  ArtNetLamps& operator=(const ArtNetLamps&) = delete;
  int port() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace patina::devices::twin::dslr
