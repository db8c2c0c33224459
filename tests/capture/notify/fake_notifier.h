// SPDX-License-Identifier: GPL-3.0-or-later
// A channel that does as it is told, and keeps what it delivered.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "capture/notify/notifier.h"

namespace patina::capture::notify {

// Outlives its channel: what a test looks at.
struct Box {
  std::mutex mutex;
  std::vector<Message> delivered;
  int tries = 0;
  bool closed = false;
  Delivery::Result result = Delivery::Result::kDelivered;
  std::function<void(const std::stop_token&)> on_send;  // may block

  std::vector<std::string> texts() {
    const std::lock_guard lock(mutex);
    std::vector<std::string> texts;
    for (const Message& m : delivered)
      texts.push_back(m.kind == MessageKind::kRun      ? m.text
                      : m.kind == MessageKind::kStatus ? "step " + std::to_string(m.state.step)
                      : m.kind == MessageKind::kFrame
                          ? "frame"
                          : std::string(patina::capture::name(m.news.event)) + " " +
                                patina::capture::name(m.news.kind));
    return texts;
  }
};

class FakeNotifier final : public Notifier {
 public:
  explicit FakeNotifier(std::shared_ptr<Box> box, std::string name = "fake")
      : box_(std::move(box)), name_(std::move(name)) {}
  ~FakeNotifier() override {
    const std::lock_guard lock(box_->mutex);
    box_->closed = true;
  }
  const std::string& name() const override { return name_; }
  bool wants(const Message&) const override { return true; }
  Nanoseconds pause() const override { return std::chrono::seconds(10); }
  Delivery send(const Message& message, const std::stop_token& hurry) override {
    if (box_->on_send) box_->on_send(hurry);
    const std::lock_guard lock(box_->mutex);
    ++box_->tries;
    if (box_->result == Delivery::Result::kDelivered) box_->delivered.push_back(message);
    return {box_->result, box_->result == Delivery::Result::kDelivered ? "ok" : "no"};
  }

 private:
  std::shared_ptr<Box> box_;
  std::string name_;
};

inline std::vector<std::unique_ptr<Notifier>> channelsInto(
    const std::vector<std::shared_ptr<Box>>& boxes) {
  std::vector<std::unique_ptr<Notifier>> channels;
  for (const auto& box : boxes) channels.push_back(std::make_unique<FakeNotifier>(box));
  return channels;
}

}  // namespace patina::capture::notify
