// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/app/json_answer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace patina::testing {

struct JsonAnswer::State {
  nlohmann::json root;
  const nlohmann::json* at(const std::string& pointer) const {
    const nlohmann::json::json_pointer place(pointer);
    return root.contains(place) ? &root.at(place) : nullptr;
  }
};

JsonAnswer::JsonAnswer(const std::string& text)
    : state_(std::make_shared<State>(State{nlohmann::json::parse(text, nullptr, false)})) {}

bool JsonAnswer::has(const std::string& pointer) const { return state_->at(pointer) != nullptr; }

std::string JsonAnswer::text(const std::string& pointer) const {
  const auto* value = state_->at(pointer);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

double JsonAnswer::number(const std::string& pointer) const {
  const auto* value = state_->at(pointer);
  return value != nullptr && value->is_number() ? value->get<double>() : std::nan("");
}

std::size_t JsonAnswer::size(const std::string& pointer) const {
  const auto* value = state_->at(pointer);
  return value == nullptr ? 0 : value->size();
}

JsonAnswer answerOf(const Finished& finished) {
  EXPECT_EQ(finished.exit, 0) << finished.err;
  return JsonAnswer(finished.out);
}

}  // namespace patina::testing
