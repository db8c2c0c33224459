// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/faults_file.h"

#include <gtest/gtest.h>

#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/temp_folder.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

DslrScript parse(const std::string& toml) {
  return parseDslrFaults(toml, "faults.toml", dslrRig("64x48"), "cam0");
}

std::string refusalOf(const std::string& fault) {
  try {
    parse("[[fault]]\n" + fault);
  } catch (const Failure& refusal) {
    EXPECT_EQ(refusal.exit(), Exit::kConfig);
    return refusal.what();
  }
  return "";
}

TEST(DslrFaults, AreOfTheCameraOrOfItsWorld) {
  const DslrScript script = parse(
      "seed = 5\n"
      "[[fault]]\nat = '90s'\ndevice = 'cam0'\nkind = 'stall'\nduration = '5s'\n"
      "operation = 'GetObject'\namount = 0.5\n"
      "[[fault]]\nat = '2min'\ndevice = 'key'\nkind = 'lamp_dead'\n"
      "[[fault]]\nat = '3min'\ndevice = 'cam0'\nkind = 'power_loss'\n");
  ASSERT_EQ(script.camera.size(), 2u);
  EXPECT_EQ(script.camera[0].kind, DslrFaultKind::kStall);
  EXPECT_EQ(script.camera[0].operation, Operation::kGetObject);
  EXPECT_EQ(script.camera[0].at, 90s);
  EXPECT_EQ(script.camera[0].duration, 5s);
  EXPECT_EQ(script.camera[0].amount, 0.5);
  EXPECT_EQ(script.camera[1].kind, DslrFaultKind::kPowerLoss);
  EXPECT_FALSE(script.camera[1].operation);
  ASSERT_EQ(script.world.faults.size(), 1u);
  EXPECT_EQ(script.world.faults[0].device, "key");
  EXPECT_EQ(script.world.seed, 5u);
}

TEST(DslrFaults, AreReadFromTheirFile) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  testing::writeFile(folder / "f.toml", "[[fault]]\nat = '1s'\ndevice = 'cam0'\nkind = 'busy'\n");
  EXPECT_EQ(readDslrFaults(folder / "f.toml", dslrRig("64x48"), "cam0").camera.size(), 1u);
}

TEST(DslrFaults, AreRefusedWithTheirLineWhenTheyCannotBe) {
  const std::string at = "at = '1s'\n";
  EXPECT_NE(refusalOf(at + "device = 'key'\nkind = 'stall'\n").find("only the virtual DSLR 'cam0'"),
            std::string::npos);
  EXPECT_NE(refusalOf(at + "device = 'cam0'\nkind = 'hang'\n").find("does not happen to a virtual"),
            std::string::npos);
  EXPECT_NE(
      refusalOf(at + "device = 'cam0'\nkind = 'stall'\noperation = 'Fly'\n").find("GetObject"),
      std::string::npos);
  EXPECT_NE(refusalOf(at + "device = 'cam0'\nkind = 'stall'\namount = 1\n").find("amount"),
            std::string::npos);
  EXPECT_NE(refusalOf(at + "device = 'cam0'\nkind = 'stall'\nsize = 1\n").find("faults.toml:"),
            std::string::npos);
  EXPECT_NE(refusalOf(at + "device = 'nolamp'\nkind = 'lamp_dead'\n").find("nolamp"),
            std::string::npos);
  EXPECT_NE(refusalOf(at + "device = 'cam0'\nkind = 'sulk'\n"), "");
}

}  // namespace
}  // namespace patina::devices::twin::dslr
