// SPDX-License-Identifier: GPL-3.0-or-later
// Where things lie when a test runs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace patina::testing {

std::filesystem::path programFolder();  // of the running test program
std::filesystem::path sourceFolder();   // the top of the tree; throws when run outside of it
std::filesystem::path program();        // the built `patina`

// A file or folder of the real data; none when $PATINA_TEST_DATA is unset.
std::optional<std::filesystem::path> testData(const std::string& name);

}  // namespace patina::testing

// Declares `variable` as the path of real data, or skips the test and says so.
// NOLINTBEGIN(bugprone-macro-parentheses): a declared name cannot stand in parentheses
#define PATINA_TEST_DATA_OR_SKIP(variable, name)                             \
  const auto variable##_found = ::patina::testing::testData(name);           \
  if (!variable##_found) GTEST_SKIP() << "PATINA_TEST_DATA is unset: " name; \
  const std::filesystem::path& variable = *variable##_found
// NOLINTEND(bugprone-macro-parentheses)
