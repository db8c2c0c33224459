// SPDX-License-Identifier: GPL-3.0-or-later
// The quick example, rehearsed once for all tests of a suite that only read its archive.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "tests/capture/app/json_answer.h"
#include "tests/support/places.h"

namespace patina::testing {

inline std::string quickPlan() { return sourceFolder() / "examples/quick/plan.toml"; }

// The quick example with some text of its plan changed, in a folder of its own.
inline std::string changedPlan(const TempFolder& folder,
                               const std::vector<std::pair<std::string, std::string>>& changes,
                               const std::string& rig_changed_from = {},
                               const std::string& rig_changed_to = {}) {
  const auto change = [](std::string& text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  std::string plan = readFile(quickPlan());
  std::string rig = readFile(sourceFolder() / "examples/quick/rig.toml");
  for (const auto& [from, to] : changes) change(plan, from, to);
  if (!rig_changed_from.empty()) change(rig, rig_changed_from, rig_changed_to);
  writeFile(folder / "plan.toml", plan);
  writeFile(folder / "rig.toml", rig);
  return folder / "plan.toml";
}

class Rehearsed : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TempFolder>(TempFolder::inMemory());
    const Finished finished = patina({"rehearse", quickPlan()});
    ASSERT_EQ(finished.exit, 0) << finished.err;
  }
  static void TearDownTestSuite() { folder_.reset(); }

  static std::string archive() { return *folder_ / "archive"; }
  static std::string place(const std::string& name) { return *folder_ / name; }
  static Finished patina(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--archive", archive()});
    return runPatina(std::move(arguments));
  }
  static JsonAnswer answer(std::vector<std::string> arguments) {
    arguments.push_back("--json");
    return answerOf(patina(std::move(arguments)));
  }

 private:
  static inline std::unique_ptr<TempFolder> folder_;
};

}  // namespace patina::testing
