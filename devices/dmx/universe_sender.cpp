// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/universe_sender.h"

#include <algorithm>
#include <exception>

namespace patina::devices::dmx {
namespace {

constexpr int kFarewells = 3;

}  // namespace

UniverseSender::UniverseSender(Universe universe, Clock& clock)
    : universe_(std::move(universe)), clock_(clock), link_(universe_.target) {}

UniverseSender::~UniverseSender() {
  if (thread_.joinable()) {
    thread_.request_stop();
    thread_.join();
  }
  slots_.fill(0);
  for (int i = 0; i < kFarewells; ++i) static_cast<void>(sendLocked());
  if (universe_.protocol != Universe::kSacn) return;
  for (int i = 0; i < kFarewells; ++i)
    static_cast<void>(
        link_.send(sacnTerminated(universe_.source, universe_.number, ++sequence_, slots_)));
}

std::optional<std::string> UniverseSender::claim(const std::string& lamp,
                                                 const std::vector<int>& slots) {
  const std::lock_guard lock(mutex_);
  for (const int slot : slots)
    if (const auto owner = owners_.find(slot); owner != owners_.end()) return owner->second;
  for (const int slot : slots) owners_[slot] = lamp;
  return std::nullopt;
}

void UniverseSender::giveUp(const std::string& lamp) {
  const std::lock_guard lock(mutex_);
  std::erase_if(owners_, [&](const auto& owned) { return owned.second == lamp; });
}

Result<void> UniverseSender::open() {
  const std::lock_guard lock(mutex_);
  if (auto opened = link_.open(); !opened) return opened;
  auto sent = sendLocked();
  cadence_.sentChange(clock_.mono());
  wake_.request_stop();
  if (clock_.threadSafe() && !thread_.joinable())
    thread_ = std::jthread([this](const std::stop_token& stop) { repeat(stop); });
  return sent;
}

Result<void> UniverseSender::put(const std::vector<SlotLevel>& levels) {
  const auto slotOf = [this](const SlotLevel& l) -> std::uint8_t& {
    return slots_[static_cast<std::size_t>(l.slot)];
  };
  const bool dark = std::ranges::all_of(levels, [](const auto& l) { return l.level == 0; });
  std::unique_lock lock(mutex_);
  const bool same =
      std::ranges::all_of(levels, [&](const auto& l) { return slotOf(l) == l.level; });
  if (same && thread_.joinable()) return last_;
  if (!dark && thread_.joinable()) {
    const MonoTime earliest = cadence_.earliest();
    lock.unlock();
    clock_.sleepUntil(earliest, {});
    lock.lock();
  }
  for (const auto& l : levels) slotOf(l) = l.level;
  auto sent = sendLocked();
  if (!sent && !dark)
    for (const auto& l : levels) slotOf(l) = 0;
  cadence_.sentChange(clock_.mono());
  wake_.request_stop();
  return sent;
}

std::vector<std::uint8_t> UniverseSender::packetLocked() {
  ++sequence_;
  if (universe_.protocol == Universe::kSacn)
    return sacnData(universe_.source, universe_.number, sequence_, slots_);
  if (sequence_ == 0) sequence_ = 1;
  return artDmx(universe_.number, sequence_, slots_);
}

Result<void> UniverseSender::sendLocked() {
  last_ = link_.send(packetLocked());
  return last_;
}

void UniverseSender::repeat(const std::stop_token& stop) {
  try {
    while (!stop.stop_requested()) {
      std::stop_source wake;
      MonoTime due;
      {
        const std::lock_guard lock(mutex_);
        wake_ = wake;
        due = cadence_.due();
      }
      const std::stop_callback on_stop(stop, [&wake] { wake.request_stop(); });
      if (clock_.sleepUntil(due, wake.get_token()) == Wake::kStopped) continue;
      const std::lock_guard lock(mutex_);
      if (clock_.mono() < cadence_.due()) continue;
      static_cast<void>(sendLocked());
      cadence_.sentAgain(clock_.mono());
    }
  } catch (const std::exception& problem) {
    const std::lock_guard lock(mutex_);
    last_ =
        fail(Errc::kLost, std::string("the universe is not repeated any more: ") + problem.what());
  }
}

}  // namespace patina::devices::dmx
