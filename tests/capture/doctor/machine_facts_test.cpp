// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/doctor/facts.h"
#include "tests/support/temp_folder.h"

namespace patina::doctor {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class MachineFactsTest : public ::testing::Test {
 protected:
  void plant(const std::string& name, const std::string& text) {
    fs::create_directories((root_ / name).parent_path());
    writeFile(root_ / name, text);
  }
  TempFolder root_ = TempFolder::inMemory();
};

TEST_F(MachineFactsTest, ReadsMemoryWithinTheLimitOfOurGroup) {
  plant("proc/meminfo", "MemTotal:  8000000 kB\nMemAvailable:  1000 kB\n");
  EXPECT_EQ(machineFacts(root_.path()).memory_free_bytes, 1'024'000u);
  plant("sys/fs/cgroup/memory.max", "500000\n");
  plant("sys/fs/cgroup/memory.current", "200000\n");
  EXPECT_EQ(machineFacts(root_.path()).memory_free_bytes, 300'000u);
  plant("sys/fs/cgroup/memory.max", "max\n");
  EXPECT_EQ(machineFacts(root_.path()).memory_free_bytes, 1'024'000u);
}

TEST_F(MachineFactsTest, FindsWhatCanPutTheMachineToSleep) {
  plant("sys/power/state", "freeze mem disk\n");
  EXPECT_THAT(machineFacts(root_.path()).unmasked_sleep, IsEmpty()) << "no systemd";
  fs::create_directories(root_ / "run/systemd/system");
  fs::create_directories(root_ / "etc/systemd/system");
  for (const char* unit : {"sleep.target", "hibernate.target", "hybrid-sleep.target"})
    fs::create_symlink("/dev/null", root_ / "etc/systemd/system" / unit);
  const MachineFacts facts = machineFacts(root_.path());
  EXPECT_THAT(facts.sleep_states, ElementsAre("freeze", "mem", "disk"));
  EXPECT_THAT(facts.unmasked_sleep, ElementsAre("suspend.target"));
}

TEST_F(MachineFactsTest, AnEmptyRootTellsNothing) {
  const MachineFacts facts = machineFacts(root_.path());
  EXPECT_FALSE(facts.memory_free_bytes);
  EXPECT_THAT(facts.sleep_states, IsEmpty());
}

TEST(MachineFacts, TheRealMachineHasDescriptorsAndMemory) {
  const MachineFacts facts = machineFacts();
  EXPECT_GT(facts.descriptors.value_or(0), 0u);
  EXPECT_GT(facts.memory_free_bytes.value_or(0), 0u);
}

}  // namespace
}  // namespace patina::doctor
