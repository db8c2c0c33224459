// SPDX-License-Identifier: GPL-3.0-or-later
// What `patina ... --json` printed, read by JSON pointers: "/items/0/run_id".
#pragma once

#include <memory>
#include <string>

#include "tests/support/child.h"

namespace patina::testing {

class JsonAnswer {
 public:
  explicit JsonAnswer(const std::string& text);  // not JSON: nothing is there
  bool has(const std::string& pointer) const;
  std::string text(const std::string& pointer) const;  // "" when it is no text
  double number(const std::string& pointer) const;     // NaN when it is no number
  std::size_t size(const std::string& pointer) const;  // of a list or object

 private:
  struct State;
  std::shared_ptr<State> state_;
};

// The answer of a verb that must have succeeded; a test failure otherwise.
JsonAnswer answerOf(const Finished& finished);

}  // namespace patina::testing
