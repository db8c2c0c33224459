// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/artnet_lamps.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <thread>
#include <utility>

#include "devices/settings.h"
#include "devices/twin/dslr/op_dmx.h"
#include "devices/twin/dslr/wire_connection.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr int kSlotsMax = 512, kUniverseMax = 0x7FFF;

}  // namespace

std::vector<DmxAddress> dmxAddresses(const RigSpec& rig) {
  std::vector<DmxAddress> addresses;
  for (const LightSpec& light : rig.lights) {
    Settings settings(light.settings, "light '" + light.id + "'", rig.source);
    const int own = static_cast<int>(addresses.size()) + 1;
    addresses.push_back({settings.takeInteger("universe", 0, kUniverseMax, 0),
                         settings.takeInteger("channel", 1, kSlotsMax, own)});
  }
  return addresses;
}

class ArtNetLamps::Impl {
 public:
  Impl(std::shared_ptr<World> world, std::vector<DmxAddress> lamps, const std::string& address,
       int port)
      : world_(std::move(world)),
        lamps_(std::move(lamps)),
        socket_(bindUdp(address, port)),
        quit_(eventfd(0, EFD_CLOEXEC)) {
    thread_ = std::thread([this] { run(); });
  }
  ~Impl() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto n = write(quit_.fd(), &one, sizeof one);
    thread_.join();
  }
  int port() const { return portOf(socket_); }

 private:
  void run() {
    std::array<std::byte, 2048> buffer;
    for (;;) {
      pollfd fds[] = {{socket_.fd(), POLLIN, 0}, {quit_.fd(), POLLIN, 0}};
      if (poll(fds, 2, -1) < 0) continue;
      if (fds[1].revents != 0) return;
      const ssize_t n = recv(socket_.fd(), buffer.data(), buffer.size(), MSG_DONTWAIT);
      if (n <= 0) continue;
      if (const auto frame = parseOpDmx(std::span(buffer).first(static_cast<std::size_t>(n))))
        obey(*frame);
    }
  }
  void obey(const DmxFrame& frame) {
    for (std::size_t i = 0; i < lamps_.size(); ++i) {
      const auto slot = static_cast<std::size_t>(lamps_[i].channel) - 1;
      if (lamps_[i].universe == frame.universe && slot < frame.slots.size())
        world_->setLamp(i, frame.slots[slot] / 255.0);
    }
  }

  std::shared_ptr<World> world_;
  std::vector<DmxAddress> lamps_;
  Socket socket_, quit_;
  std::thread thread_;
};

ArtNetLamps::ArtNetLamps(std::shared_ptr<World> world, std::vector<DmxAddress> lamps,
                         const std::string& address, int port)
    : impl_(std::make_unique<Impl>(std::move(world), std::move(lamps), address, port)) {}
ArtNetLamps::~ArtNetLamps() = default;
int ArtNetLamps::port() const { return impl_->port(); }

}  // namespace patina::devices::twin::dslr
