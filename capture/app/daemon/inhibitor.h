// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the machine awake while a run is active: a lock of logind, held as an open descriptor, so
// that it goes with the process.
#pragma once

#include <string>

namespace patina::daemon {

// Thread-bound.
class Inhibitor {
 public:
  Inhibitor() = default;
  ~Inhibitor() { release(); }
  Inhibitor(const Inhibitor&) = delete;
  Inhibitor& operator=(const Inhibitor&) = delete;

  // Asks logind over the system bus. Answers why it could not, once; then, and when it has the
  // lock, nothing. Waits for the bus for at most five seconds.
  std::string take();
  void release();
  bool held() const { return lock_ >= 0; }

 private:
  int lock_ = -1;
  bool refused_ = false;
};

}  // namespace patina::daemon
