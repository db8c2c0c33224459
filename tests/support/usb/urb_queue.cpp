// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usb/urb_queue.h"

#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>

namespace patina::testing {

void* refObject(void* object) { return g_object_ref(object); }
void Unref::operator()(void* object) const { g_object_unref(object); }

usbdevfs_urb& Urb::head() const { return *reinterpret_cast<usbdevfs_urb*>(memory->data); }

std::span<std::byte> Urb::bytes() const {
  if (!buffer) return {};
  return {reinterpret_cast<std::byte*>(buffer->data), static_cast<std::size_t>(buffer->data_len)};
}

int UrbQueue::submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  Urb urb;
  UMockdevIoctlData* const memory =
      umockdev_ioctl_data_resolve(argument, 0, sizeof(usbdevfs_urb), nullptr);
  if (memory == nullptr) return EFAULT;
  urb.client = hold(client);
  urb.memory = hold(memory);
  urb.address = memory->client_addr;
  const int length = urb.head().buffer_length;
  if (length < 0) return EINVAL;
  if (length > 0) {
    UMockdevIoctlData* const buffer = umockdev_ioctl_data_resolve(
        memory, offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(length), nullptr);
    if (buffer == nullptr) return EFAULT;
    urb.buffer = hold(buffer);
  }
  waiting_.push_back(std::move(urb));
  return 0;
}

int UrbQueue::discard(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);  // resolved, it would be another
  const auto urb = std::ranges::find_if(waiting_, [&](const Urb& one) {
    return one.address == address && one.client.get() == client;
  });
  if (urb == waiting_.end()) return EINVAL;
  finish(urb, {-ENOENT, 0});
  return 0;
}

void UrbQueue::reap(UMockdevIoctlClient* client, MonoTime due) {
  reapers_.push_back({hold(client), due});
}

void UrbQueue::finish(std::list<Urb>::iterator urb, const Outcome& outcome) {
  urb->head().status = outcome.status;
  urb->head().actual_length = static_cast<int>(outcome.bytes);
  done_.splice(done_.end(), waiting_, urb);
}

void UrbQueue::failAll(int status) {
  while (!waiting_.empty()) finish(waiting_.begin(), {status, 0});
}

void UrbQueue::answerReapers(MonoTime now, bool gone) {
  for (auto reaper = reapers_.begin(); reaper != reapers_.end();) {
    const auto here = reaper++;
    UMockdevIoctlClient* const client = here->client.get();
    const auto urb =
        std::ranges::find_if(done_, [&](const Urb& one) { return one.client.get() == client; });
    if (urb != done_.end()) {
      UMockdevIoctlData* const reaped = umockdev_ioctl_data_resolve(
          umockdev_ioctl_client_get_arg(client), 0, sizeof(void*), nullptr);
      if (reaped != nullptr) umockdev_ioctl_data_set_ptr(reaped, 0, urb->memory.get());
      done_.erase(urb);
      umockdev_ioctl_client_complete(client, 0, 0);
    } else if (gone || here->due <= now) {
      umockdev_ioctl_client_complete(client, -1, gone ? ENODEV : EAGAIN);
    } else {
      continue;
    }
    reapers_.erase(here);
  }
}

void UrbQueue::forgetTheDead() {
  const auto isDead = [](const Urb& urb) {
    return umockdev_ioctl_client_get_connected(urb.client.get()) == FALSE;
  };
  waiting_.remove_if(isDead);
  done_.remove_if(isDead);
  reapers_.remove_if([](const Reaper& reaper) {
    return umockdev_ioctl_client_get_connected(reaper.client.get()) == FALSE;
  });
}

std::optional<MonoTime> UrbQueue::nextDue() const {
  std::optional<MonoTime> next;
  for (const Reaper& reaper : reapers_)
    if (!next || reaper.due < *next) next = reaper.due;
  return next;
}

}  // namespace patina::testing
