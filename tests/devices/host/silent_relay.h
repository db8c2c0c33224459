// SPDX-License-Identifier: GPL-3.0-or-later
// Between a caller and a device host: carries bytes both ways until it is told to fall silent. Then
// connections stay as they are and nothing more comes through, as when packets are dropped.
#pragma once

#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "devices/descriptor.h"

namespace patina::devices::host {

class SilentRelay {
 public:
  explicit SilentRelay(std::string to);  // "127.0.0.1:PORT"
  ~SilentRelay();
  SilentRelay(const SilentRelay&) = delete;
  SilentRelay& operator=(const SilentRelay&) = delete;

  std::string address() const { return address_; }
  // The connections there are are dead for good; new ones get through again.
  void silence() { ++silences_; }

 private:
  struct Pair {
    Descriptor caller, host;
    int born = 0;  // silences until then
    bool over = false;
  };
  void run();
  void carry(Pair& pair, const Descriptor& from, const Descriptor& to);

  std::string to_, address_;
  Descriptor listener_, quit_;
  std::atomic<int> silences_ = 0;
  std::vector<Pair> pairs_;
  std::thread thread_;
};

}  // namespace patina::devices::host
