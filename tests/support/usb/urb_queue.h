// SPDX-License-Identifier: GPL-3.0-or-later
// The requests that programs have made of one plugged-in device, as usbdevfs keeps them: submitted,
// done, reaped.
#pragma once

#include <linux/usbdevice_fs.h>

#include <cstdint>
#include <list>
#include <memory>
#include <optional>
#include <span>

#include "processing/image/picture_file.h"

// Of umockdev, whose header stays out of this one.
struct _UMockdevIoctlClient;
struct _UMockdevIoctlData;
using UMockdevIoctlClient = _UMockdevIoctlClient;
using UMockdevIoctlData = _UMockdevIoctlData;

namespace patina::testing {

void* refObject(void* object);
struct Unref {
  void operator()(void* object) const;
};
template <class T>
using GObjectPointer = std::unique_ptr<T, Unref>;
template <class T>
GObjectPointer<T> hold(T* object) {
  return GObjectPointer<T>(static_cast<T*>(refObject(object)));
}

struct Urb {
  GObjectPointer<UMockdevIoctlClient> client;
  GObjectPointer<UMockdevIoctlData> memory, buffer;  // in the program; the latter null when empty
  unsigned long address = 0;                         // its name, in the program

  usbdevfs_urb& head() const;
  std::span<std::byte> bytes() const;
};

// Thread-bound: its device's lock guards it.
class UrbQueue {
 public:
  // What answers a request. Status 0 or a negative errno; nothing: not yet.
  struct Outcome {
    int status = 0;
    std::size_t bytes = 0;
  };

  // 0 or an errno.
  int submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  int discard(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  // Waits for a request that is done, at most until `due`: then EAGAIN.
  void reap(UMockdevIoctlClient* client, MonoTime due);

  // Each request that waits, the oldest of each pipe first, is offered to `answer`.
  template <class Answer>
  void answer(Answer&& answer);
  void failAll(int status);  // what waits
  void answerReapers(MonoTime now, bool gone);
  std::optional<MonoTime> nextDue() const;

 private:
  struct Reaper {
    GObjectPointer<UMockdevIoctlClient> client;
    MonoTime due;
  };
  void finish(std::list<Urb>::iterator urb, const Outcome& outcome);
  void forgetTheDead();

  std::list<Urb> waiting_, done_;
  std::list<Reaper> reapers_;
};

template <class Answer>
void UrbQueue::answer(Answer&& answer) {
  forgetTheDead();
  std::uint32_t held = 0;  // pipes whose first request waits: those behind it do too
  for (auto urb = waiting_.begin(); urb != waiting_.end();) {
    const auto here = urb++;
    const std::uint8_t pipe = here->head().endpoint;
    const std::uint32_t bit = 1u << ((pipe & 0xf) | (pipe >> 3 & 0x10));
    if ((held & bit) != 0) continue;
    if (const std::optional<Outcome> outcome = answer(*here))
      finish(here, *outcome);
    else
      held |= bit;
  }
}

}  // namespace patina::testing
