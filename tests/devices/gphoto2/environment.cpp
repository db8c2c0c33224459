// SPDX-License-Identifier: GPL-3.0-or-later
// What the process of a driver is given by its host: a HOME of its own, no SIGPIPE, one time zone.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

class OwnHome : public ::testing::Environment {
 public:
  void SetUp() override {
    std::signal(SIGPIPE, SIG_IGN);
    ::setenv("HOME", home_.path().c_str(), 1);
    ::setenv("LC_ALL", "C", 1);
  }

 private:
  TempFolder home_ = TempFolder::inMemory();
};

const auto* const kOwnHome = ::testing::AddGlobalTestEnvironment(new OwnHome);

}  // namespace
}  // namespace patina::testing
