// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/serial/termios_port.h"

#include <gmock/gmock.h>

#include "tests/devices/serial/pty.h"
#include "tests/support/matchers.h"
#include "tests/support/temp_folder.h"

namespace patina::devices::serial {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::Pty;
using patina::testing::TempFolder;
using ::testing::HasSubstr;

class TermiosPort : public ::testing::Test {
 protected:
  std::shared_ptr<Port> opened(const Pty& pty) {
    auto port = makeTermiosPort({pty.path(), 9600, 0ns, false}, clock_);
    EXPECT_THAT(port->open(), IsOk());
    return port;
  }
  MonoTime soon() { return clock_.mono() + 10s; }
  RealClock clock_;
};

TEST_F(TermiosPort, CarriesLinesBothWays) {
  Pty pty([](const std::string& line) { return "\r\n" + line + " yourself\r\n"; });
  const auto port = opened(pty);
  ASSERT_THAT(port->send("hello\n", soon()), IsOk());
  const auto line = port->readLine(soon());
  ASSERT_THAT(line, IsOk());
  EXPECT_EQ(*line, "hello yourself");
}

TEST_F(TermiosPort, AsksUntilTheExpectedLineComes) {
  Pty pty([](const std::string&) { return "boot 1.2\nnoise\nOK 5\nmore\n"; });
  EXPECT_EQ(*opened(pty)->ask("STATE\n", "OK", soon()), "OK 5");
}

TEST_F(TermiosPort, AnswersWhatCameLastWhenTheExpectedLineDoesNot) {
  Pty pty([](const std::string&) { return "ERR 7\n"; });
  EXPECT_EQ(*opened(pty)->ask("STATE\n", "OK", clock_.mono() + 50ms), "ERR 7");
}

TEST_F(TermiosPort, ThrowsAwayWhatCameBeforeTheQuestion) {
  Pty pty([](const std::string&) { return "new\n"; });
  const auto port = opened(pty);
  pty.sayAndArrive("old\nold\nol");
  EXPECT_EQ(*port->ask("?\n", "", soon()), "new");
}

TEST_F(TermiosPort, KeepsItsDeadlineWhenNothingComes) {
  Pty pty;
  const auto port = opened(pty);
  EXPECT_THAT(port->readLine(clock_.mono() + 5ms), Fails(Errc::kTimeout));
  EXPECT_THAT(port->readLine(clock_.mono() - 1h), Fails(Errc::kTimeout));
}

TEST_F(TermiosPort, IsLostWhenUnpluggedAndOpensItsNameAgain) {
  TempFolder folder;
  const auto name = folder / "lamp";
  auto pty = std::make_unique<Pty>();
  std::filesystem::create_symlink(pty->path(), name);
  const auto port = makeTermiosPort({name.string(), 9600, 0ns, false}, clock_);
  ASSERT_THAT(port->open(), IsOk());
  pty->unplug();
  EXPECT_THAT(port->readLine(soon()), Fails(Errc::kLost));
  EXPECT_THAT(port->send("x\n", soon()), Fails(Errc::kLost));
  EXPECT_THAT(port->open(), Fails(Errc::kLost));
  Pty again([](const std::string&) { return "here\n"; });  // under another number
  std::filesystem::remove(name);
  std::filesystem::create_symlink(again.path(), name);
  ASSERT_THAT(port->open(), IsOk());
  EXPECT_EQ(*port->ask("?\n", "", soon()), "here");
}

TEST_F(TermiosPort, OpensAgainAfterAHangUpNobodyNoticed) {
  TempFolder folder;
  const auto name = folder / "lamp";
  auto pty = std::make_unique<Pty>();
  std::filesystem::create_symlink(pty->path(), name);
  const auto port = makeTermiosPort({name.string(), 9600, 0ns, false}, clock_);
  ASSERT_THAT(port->open(), IsOk());
  pty->unplug();
  Pty again([](const std::string&) { return "here\n"; });
  std::filesystem::remove(name);
  std::filesystem::create_symlink(again.path(), name);
  ASSERT_THAT(port->open(), IsOk());
  EXPECT_EQ(*port->ask("?\n", "", soon()), "here");
}

TEST_F(TermiosPort, RefusesAPortThatAnotherHas) {
  Pty pty;
  const auto first = opened(pty);
  const auto second = makeTermiosPort({pty.path(), 9600, 0ns, false}, clock_);
  EXPECT_THAT(second->open(), Fails(Errc::kBusy));
}

TEST_F(TermiosPort, SaysWhatIsThereInsteadOfAMissingOne) {
  const auto port = makeTermiosPort({"/dev/serial/by-id/none", 9600, 0ns, false}, clock_);
  const auto error = port->open();
  ASSERT_THAT(error, Fails(Errc::kLost));
  EXPECT_THAT(error.error().what, HasSubstr("/dev/serial/by-id/none"));
  EXPECT_THAT(error.error().what, HasSubstr("there are"));
}

TEST_F(TermiosPort, IsNoFileAndNeedsControlLinesForOutputs) {
  TempFolder folder;
  patina::testing::writeFile(folder / "file", "");
  const auto file = makeTermiosPort({(folder / "file").string(), 9600, 0ns, false}, clock_);
  const auto error = file->open();
  ASSERT_THAT(error, Fails(Errc::kLost));
  EXPECT_THAT(error.error().what, HasSubstr("no serial port"));
  Pty pty;
  const auto lines = makeTermiosPort({pty.path(), 9600, 0ns, true}, clock_);
  EXPECT_THAT(lines->open(), Fails(Errc::kUnsupported));
}

TEST_F(TermiosPort, TakesNoEndlessLine) {
  Pty pty;
  const auto port = opened(pty);
  std::thread chatter([&pty] {
    for (int i = 0; i < 6; ++i) pty.say(std::string(1000, 'x'));
  });
  EXPECT_THAT(port->readLine(soon()), Fails(Errc::kCorrupt));
  chatter.join();
}

TEST(StableNames, AreThoseOfTheFolderInOrder) {
  TempFolder root;
  std::filesystem::create_directories(root / "dev/serial/by-id");
  for (const char* name : {"usb-b", "usb-a"})
    patina::testing::writeFile(root / "dev/serial/by-id" / name, "");
  const auto names = stableNames(root.path());
  ASSERT_EQ(names.size(), 2u);
  EXPECT_EQ(names[0].filename(), "usb-a");
  EXPECT_TRUE(stableNames(root / "nowhere").empty());
}

}  // namespace
}  // namespace patina::devices::serial
