// SPDX-License-Identifier: GPL-3.0-or-later
// Progress and stop of a long computation. An algorithm reports and asks; it never prints.
#pragma once

#include <atomic>
#include <cstdint>
#include <stdexcept>
#include <string_view>

namespace patina {

// Thrown by Progress::step() after stop was asked for; no output has been left behind.
class Stopped : public std::runtime_error {
 public:
  Stopped() : std::runtime_error("stopped") {}
};

// Thread-safe. The default object reports to nobody and never stops.
class Progress {
 public:
  virtual ~Progress() = default;

  // A stage of `total` units begins; stages follow one another.
  virtual void begin(std::string_view stage, std::int64_t total) {
    (void)stage;
    (void)total;
  }
  // `done` more units are finished. Throws Stopped when stop was asked for.
  void step(std::int64_t done = 1) {
    if (stop_.load(std::memory_order_relaxed)) throw Stopped();
    advance(done);
  }
  void askToStop() { stop_.store(true, std::memory_order_relaxed); }  // async-signal-safe
  bool stopAsked() const { return stop_.load(std::memory_order_relaxed); }

 protected:
  virtual void advance(std::int64_t done) { (void)done; }

 private:
  std::atomic<bool> stop_{false};
};

}  // namespace patina
