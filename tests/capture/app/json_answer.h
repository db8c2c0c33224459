// SPDX-License-Identifier: GPL-3.0-or-later
// What `patina ... --json` printed.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/child.h"

namespace patina::testing {

inline nlohmann::json parsed(const std::string& text) {
  return nlohmann::json::parse(text, nullptr, false);
}
// The first item of an answer; an empty object when there is none.
inline nlohmann::json itemOf(const Finished& finished) {
  const nlohmann::json answer = parsed(finished.out);
  if (!answer.is_object() || !answer.contains("items") || answer["items"].empty())
    return nlohmann::json::object();
  return answer["items"][0];
}

}  // namespace patina::testing
