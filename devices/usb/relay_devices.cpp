// SPDX-License-Identifier: GPL-3.0-or-later
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "devices/light_settings.h"
#include "devices/trigger_pulse.h"
#include "devices/usb/hid_relay.h"
#include "devices/usb/usb.h"

namespace patina::devices::usb {
namespace {

// The devices of one board share it as long as one of them lives.
std::shared_ptr<RelayBoard> boardOf(const std::string& serial, const UsbPlaces& places) {
  static std::mutex mutex;
  static std::map<std::pair<std::string, std::string>, std::weak_ptr<RelayBoard>> boards;
  const std::lock_guard lock(mutex);
  std::erase_if(boards, [](const auto& entry) { return entry.second.expired(); });
  auto& known = boards[{places.root.string(), serial}];
  auto board = known.lock();
  if (!board) known = board = std::make_shared<RelayBoard>(serial, places.open_hid, places.root);
  return board;
}

Result<void> named(const std::string& id, const char* call, Result<void> done) {
  if (done) return done;
  return fail(done.error().code, "usb '" + id + "': " + call + ": " + done.error().what);
}

class RelayLight final : public Light {
 public:
  RelayLight(LightCaps caps, int relay, std::shared_ptr<RelayBoard> board)
      : caps_(std::move(caps)), relay_(relay), board_(std::move(board)) {}
  ~RelayLight() override { static_cast<void>(board_->set(relay_, false)); }

  const LightCaps& caps() const override { return caps_; }
  Result<void> set(double level) override {
    if (auto good = checkLevel(level, "usb '" + caps_.id + "'"); !good) return good;
    return named(caps_.id, "set", board_->set(relay_, level > 0));
  }
  Result<std::optional<bool>> isOn() override {
    const auto closed = board_->isClosed(relay_);
    if (!closed)
      return fail(closed.error().code, "usb '" + caps_.id + "': isOn: " + closed.error().what);
    return std::optional<bool>(*closed);
  }
  Result<void> recover() override {
    if (auto opened = board_->open(); !opened) return named(caps_.id, "recover", opened);
    return named(caps_.id, "recover", board_->set(relay_, false));
  }

 private:
  const LightCaps caps_;
  const int relay_;
  const std::shared_ptr<RelayBoard> board_;
};

class RelayTrigger final : public Trigger {
 public:
  RelayTrigger(std::string id, int relay, int half_relay, TriggerPulse pulse,
               std::shared_ptr<RelayBoard> board, Clock& clock)
      : id_(std::move(id)),
        relay_(relay),
        half_relay_(half_relay),
        pulse_(pulse),
        board_(std::move(board)),
        clock_(clock) {}
  ~RelayTrigger() override { static_cast<void>(letGo()); }

  const std::string& id() const override { return id_; }
  Result<MonoTime> fire() override {
    LineDrive half;
    if (half_relay_ > 0) half = [this](bool on) { return board_->set(half_relay_, on); };
    const auto at = press(
        pulse_, [this](bool on) { return board_->set(relay_, on); }, half, clock_);
    if (!at) return fail(at.error().code, "usb '" + id_ + "': fire: " + at.error().what);
    return *at;
  }
  Result<void> recover() override {
    if (auto opened = board_->open(); !opened) return named(id_, "recover", opened);
    return named(id_, "recover", letGo());
  }

 private:
  Result<void> letGo() {
    auto done = board_->set(relay_, false);
    if (half_relay_ == 0) return done;
    auto half = board_->set(half_relay_, false);
    return done ? half : done;
  }

  const std::string id_;
  const int relay_, half_relay_;  // half: 0 = none
  const TriggerPulse pulse_;
  const std::shared_ptr<RelayBoard> board_;
  Clock& clock_;
};

}  // namespace

std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock&, const UsbPlaces& places) {
  Settings settings(spec.settings, "light '" + spec.id + "'", rig_file);
  LightCaps caps = takeLightCaps(settings, spec.id);
  caps.confirms = true;
  const int relay = settings.takeInteger("relay", 1, kRelaysMax, 1);
  settings.finish();
  return std::make_unique<RelayLight>(std::move(caps), relay, boardOf(spec.address, places));
}

std::unique_ptr<Trigger> makeTrigger(const TriggerSpec& spec, const std::filesystem::path& rig_file,
                                     Clock& clock, const UsbPlaces& places) {
  Settings settings(spec.settings, "trigger '" + spec.id + "'", rig_file);
  const int relay = settings.takeInteger("relay", 1, kRelaysMax, 1);
  const int half_relay = settings.takeInteger("half_relay", 0, kRelaysMax, 0);
  const TriggerPulse pulse = takeTriggerPulse(settings);
  settings.finish();
  if (half_relay == relay) settings.reject("half_relay", "must be another relay");
  return std::make_unique<RelayTrigger>(spec.id, relay, half_relay, pulse,
                                        boardOf(spec.address, places), clock);
}

}  // namespace patina::devices::usb
