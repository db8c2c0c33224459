// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/dmx.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <mutex>
#include <sstream>
#include <utility>

#include "devices/config_file.h"
#include "devices/dmx/universe_sender.h"
#include "devices/light_settings.h"
#include "processing/image/random.h"

namespace patina::devices::dmx {
namespace {

struct DmxLamp {
  LightCaps caps;
  Universe universe;
  std::vector<int> channels;  // coarse ones, from 1
  int bits = 8;
  double full = 1;
};

// From this machine and the rig's name for the universe: the same after a restart.
std::array<std::uint8_t, 16> cidOf(const std::string& line) {
  std::string machine;
  std::ifstream("/etc/machine-id") >> machine;
  std::array<std::uint8_t, 16> cid{};
  for (std::uint64_t half = 0; half < 2; ++half) {
    std::uint64_t h = hashSeed(half);
    for (const char c : machine + "/" + line) h = hashSeed(h, static_cast<unsigned char>(c));
    for (std::size_t i = 0; i < 8; ++i) cid[half * 8 + i] = static_cast<std::uint8_t>(h >> (8 * i));
  }
  cid[6] = static_cast<std::uint8_t>((cid[6] & 0x0f) | 0x80);  // RFC 9562: version 8, our own
  cid[8] = static_cast<std::uint8_t>((cid[8] & 0x3f) | 0x80);
  return cid;
}

std::vector<int> takeChannels(Settings& settings, int bits) {
  const int last = bits == 16 ? 511 : 512;
  const std::string list = settings.takeText("channels", "");
  std::vector<int> channels;
  if (list.empty()) {
    channels.push_back(settings.takeInteger("channel", 1, last, 1));
    return channels;
  }
  if (!settings.takeText("channel", "").empty())
    settings.reject("channels", "stands beside channel: give one of the two");
  std::istringstream words(list);
  for (std::string word; std::getline(words, word, ',');) {
    std::istringstream in(word);
    int channel = 0;
    if (!(in >> channel) || !(in >> std::ws).eof() || channel < 1 || channel > last)
      settings.reject("channels",
                      "'" + word + "' is no channel (1 to " + std::to_string(last) + ")");
    channels.push_back(channel);
  }
  return channels;
}

void takeTarget(Settings& settings, const LightSpec& spec, Universe& universe) {
  const bool sacn = universe.protocol == Universe::kSacn;
  universe.number = sacn ? settings.takeInteger("universe", 1, kSacnUniverseMax, 1)
                         : settings.takeInteger("universe", 0, kArtNetUniverseMax, 0);
  universe.target.host = spec.address;
  universe.target.port = settings.takeInteger("port", 1, 65535, sacn ? kSacnPort : kArtNetPort);
  universe.target.interface = settings.takeText("interface", "");
  if (sacn && spec.address.empty()) universe.target.host = sacnMulticastGroup(universe.number);
  if (!isIpv4(universe.target.host))
    settings.reject("address",
                    "'" + spec.address + "' is no IPv4 address of a node, such as 10.0.0.7");
  if (!universe.target.interface.empty() && !isIpv4(universe.target.interface))
    settings.reject("interface", "'" + universe.target.interface + "' is no IPv4 address");
}

std::string lineOf(const Universe& universe) {
  return std::string(universe.protocol == Universe::kSacn ? "sacn" : "artnet") + " " +
         universe.target.host + ":" + std::to_string(universe.target.port) + " universe " +
         std::to_string(universe.number);
}

DmxLamp parse(const LightSpec& spec, const std::filesystem::path& rig_file) {
  Settings settings(spec.settings, "light '" + spec.id + "'", rig_file);
  DmxLamp lamp;
  lamp.caps = takeLightCaps(settings, spec.id);
  if (spec.backend != "artnet" && spec.backend != "sacn")
    settings.reject("backend", "'" + spec.backend + "' is none of artnet, sacn");
  lamp.universe.protocol = spec.backend == "sacn" ? Universe::kSacn : Universe::kArtNet;
  takeTarget(settings, spec, lamp.universe);
  lamp.bits = settings.takeChoice("bits", {"8", "16"}) == "16" ? 16 : 8;
  lamp.channels = takeChannels(settings, lamp.bits);
  lamp.full = settings.takeNumber("full", 0.001, 1, 1);
  if (lamp.universe.protocol == Universe::kSacn) {
    lamp.universe.source.priority = settings.takeInteger("priority", 0, 200, 100);
    lamp.universe.source.name = settings.takeText("source", "Patina");
    lamp.universe.source.cid = cidOf(lineOf(lamp.universe));
  }
  settings.finish();
  return lamp;
}

// The one sender of a line, kept as long as a lamp of it lives.
std::shared_ptr<UniverseSender> senderOf(const Universe& universe, Clock& clock) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, Clock*>, std::weak_ptr<UniverseSender>> senders;
  const std::lock_guard lock(mutex);
  std::erase_if(senders, [](const auto& entry) { return entry.second.expired(); });
  auto& known = senders[{lineOf(universe), &clock}];
  auto sender = known.lock();
  if (!sender) known = sender = std::make_shared<UniverseSender>(universe, clock);
  return sender;
}

class DmxLight final : public Light {
 public:
  DmxLight(DmxLamp lamp, std::shared_ptr<UniverseSender> sender, std::string backend)
      : lamp_(std::move(lamp)),
        sender_(std::move(sender)),
        who_(std::move(backend) + " '" + lamp_.caps.id + "'") {}
  ~DmxLight() override {
    static_cast<void>(sender_->put(levels(0)));
    sender_->giveUp(lamp_.caps.id);
  }

  const LightCaps& caps() const override { return lamp_.caps; }
  Result<void> set(double level) override {
    if (auto good = checkLevel(level, who_); !good) return good;
    return named("set", sender_->put(levels(level)));
  }
  Result<std::optional<bool>> isOn() override { return std::optional<bool>{}; }
  Result<void> recover() override {
    if (auto opened = sender_->open(); !opened) return named("recover", opened);
    return named("recover", sender_->put(levels(0)));
  }

 private:
  // Any light at all is at least one step of the lamp.
  std::vector<SlotLevel> levels(double level) const {
    const double steps = lamp_.bits == 16 ? 65535 : 255;
    const int v =
        level > 0 ? std::max(1, static_cast<int>(std::lround(level * lamp_.full * steps))) : 0;
    std::vector<SlotLevel> levels;
    for (const int channel : lamp_.channels) {
      levels.push_back({channel - 1, static_cast<std::uint8_t>(lamp_.bits == 16 ? v >> 8 : v)});
      if (lamp_.bits == 16) levels.push_back({channel, static_cast<std::uint8_t>(v & 0xff)});
    }
    return levels;
  }
  Result<void> named(const char* call, Result<void> done) const {
    if (done) return done;
    return fail(done.error().code, who_ + ": " + call + ": " + done.error().what);
  }

  const DmxLamp lamp_;
  const std::shared_ptr<UniverseSender> sender_;
  const std::string who_;
};

}  // namespace

std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock& clock) {
  DmxLamp lamp = parse(spec, rig_file);
  auto sender = senderOf(lamp.universe, clock);
  std::vector<int> slots;
  for (const int channel : lamp.channels)
    for (int i = 0; i < lamp.bits / 8; ++i) slots.push_back(channel - 1 + i);
  std::ranges::sort(slots);
  const auto refuse = [&](const std::string& why) {
    throw ConfigError(rig_file, 0, "light '" + spec.id + "': settings.channel", why);
  };
  if (std::ranges::adjacent_find(slots) != slots.end()) refuse("one channel stands there twice");
  const Universe& first = sender->universe();
  if (first.target.interface != lamp.universe.target.interface ||
      first.source.priority != lamp.universe.source.priority ||
      first.source.name != lamp.universe.source.name)
    refuse("lamps of one universe must agree on interface, priority and source");
  if (const auto owner = sender->claim(spec.id, slots))
    refuse("light '" + *owner + "' has one of these channels already");
  return std::make_unique<DmxLight>(std::move(lamp), std::move(sender), spec.backend);
}

std::string sharedLine(const LightSpec& spec) { return lineOf(parse(spec, {}).universe); }

}  // namespace patina::devices::dmx
