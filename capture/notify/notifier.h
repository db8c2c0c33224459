// SPDX-License-Identifier: GPL-3.0-or-later
// One way to tell somebody.
#pragma once

#include <stop_token>
#include <string>

#include "capture/notify/message.h"
#include "processing/image/failure.h"

namespace patina::capture::notify {

// A channel that cannot be made as it was asked for: a secret that is not there, a bad address.
class NotifyError : public Failure {
 public:
  using Failure::Failure;
};

struct Delivery {
  enum class Result { kDelivered, kTryAgain, kRefused };  // refused: another try would be no better
  Result result = Result::kDelivered;
  std::string answer;  // "HTTP 204", "no answer within 10s": one line without secrets

  bool delivered() const { return result == Result::kDelivered; }
};

class Notifier {  // Thread-bound to whoever sends; made on any thread.
 public:
  virtual ~Notifier() = default;
  virtual const std::string& name() const = 0;  // "webhook hooks.example.org", without secrets
  virtual bool wants(const Message& message) const = 0;
  // The least time between two messages of a kind of which only the newest counts.
  virtual Nanoseconds pause() const = 0;
  // Returns within half a minute, and within two seconds when `hurry` is asked for.
  virtual Delivery send(const Message& message, const std::stop_token& hurry) = 0;
};

}  // namespace patina::capture::notify
