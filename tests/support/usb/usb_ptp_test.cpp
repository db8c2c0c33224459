// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/usb/usb_ptp.h"

#include <gtest/gtest.h>

#include "devices/twin/dslr/ptp_data.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/usb/usb_descriptors.h"

namespace patina::testing {
namespace {

using namespace devices::twin::dslr;
using namespace std::chrono_literals;

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int v : values) out.push_back(static_cast<std::byte>(v));
  return out;
}

Bytes command(Operation operation, std::uint32_t transaction,
              const std::vector<std::uint32_t>& parameters = {}) {
  PtpWriter out;
  out.u32(static_cast<std::uint32_t>(12 + 4 * parameters.size()));
  out.u16(1);
  out.u16(static_cast<std::uint16_t>(operation));
  out.u32(transaction);
  for (const std::uint32_t p : parameters) out.u32(p);
  return out.take();
}

class UsbPtpTest : public ::testing::Test {
 protected:
  void SetUp() override {
    EXPECT_TRUE(usb_.bulkOut(command(Operation::kOpenSession, 0, {1})));
    EXPECT_EQ(usb_.bulkIn(512)->bytes, bytes({12, 0, 0, 0, 3, 0, 0x01, 0x20, 0, 0, 0, 0}));
  }
  // Every byte of the data or response that comes next, in transfers of `most`.
  Bytes next(std::size_t most) {
    Bytes whole;
    while (const auto part = usb_.bulkIn(most)) {
      whole.insert(whole.end(), part->bytes.begin(), part->bytes.end());
      if (PtpReader(whole).u32() == whole.size()) return whole;
    }
    return whole;
  }

  devices::VirtualClock clock_{parseUtc("2024-05-01T12:00:00Z")};
  Dslr camera_{dslrWorld(clock_), {}};
  UsbPtp usb_{camera_};
};

TEST_F(UsbPtpTest, AnswersDataThenResponseInTransfersOfAnySize) {
  for (const std::size_t most : {12u, 64u, 512u, 16'384u}) {
    usb_.bulkOut(command(Operation::kGetDeviceInfo, 7));
    const Bytes data = next(most);
    EXPECT_EQ(PtpReader(data).u32(), data.size());
    EXPECT_EQ(data[4], std::byte{2});
    EXPECT_EQ(next(most), bytes({12, 0, 0, 0, 3, 0, 0x01, 0x20, 7, 0, 0, 0}));
    EXPECT_FALSE(usb_.bulkIn(most));
  }
}

TEST_F(UsbPtpTest, TakesDataInPieces) {
  EXPECT_TRUE(usb_.bulkOut(command(Operation::kSetDevicePropValue, 8,
                                   {static_cast<std::uint32_t>(Property::kFNumber)})));
  EXPECT_FALSE(usb_.bulkIn(512));
  EXPECT_TRUE(usb_.bulkOut(bytes({14, 0, 0, 0, 2, 0, 0x16, 0x10, 8, 0, 0, 0})));
  EXPECT_TRUE(usb_.bulkOut(bytes({0x30, 0x02})));  // f/5.6
  EXPECT_EQ(next(512), bytes({12, 0, 0, 0, 3, 0, 0x01, 0x20, 8, 0, 0, 0}));
}

TEST_F(UsbPtpTest, StallsThePipeForWhatIsNoCommand) {
  for (const Bytes& bad : {bytes({1, 2, 3}), bytes({99, 0, 0, 0, 1, 0, 2, 16, 0, 0, 0, 0}),
                           bytes({12, 0, 0, 0, 9, 0, 2, 16, 0, 0, 0, 0})})
    EXPECT_EQ(usb_.bulkOut(bad)->kind, UsbTransfer::kStalledPipe);
}

TEST_F(UsbPtpTest, TellsOfPicturesOnTheInterruptPipe) {
  usb_.bulkOut(command(Operation::kInitiateCapture, 9, {0, 0}));
  EXPECT_EQ(next(512).size(), 12u);
  clock_.advance(1s);
  usb_.takeEvents();
  const auto event = usb_.interruptIn(64);
  ASSERT_TRUE(event);
  EXPECT_EQ(Bytes(event->bytes.begin(), event->bytes.begin() + 8),
            bytes({16, 0, 0, 0, 4, 0, 0x02, 0x40}));
  EXPECT_TRUE(usb_.interruptIn(64));
  EXPECT_FALSE(usb_.interruptIn(64));
}

TEST_F(UsbPtpTest, IsSilentOnAllPipesWhileItStalls) {
  camera_.order(
      {.kind = DslrFaultKind::kStall, .operation = Operation::kGetStorageIds, .duration = 2s});
  usb_.bulkOut(command(Operation::kGetStorageIds, 3));
  EXPECT_FALSE(usb_.bulkIn(512));
  EXPECT_EQ(usb_.nextDue(), clock_.mono() + 2s);
  EXPECT_FALSE(usb_.bulkOut(command(Operation::kGetStorageIds, 4)));
  clock_.advance(2s);
  EXPECT_EQ(next(512).size(), 24u);
}

TEST_F(UsbPtpTest, LeavesTheBusForAResetAndStallsThePipeForAClose) {
  camera_.order({.kind = DslrFaultKind::kClose, .operation = Operation::kGetStorageIds});
  usb_.bulkOut(command(Operation::kGetStorageIds, 3));
  EXPECT_EQ(usb_.bulkIn(512)->kind, UsbTransfer::kStalledPipe);
  EXPECT_FALSE(usb_.wantsUnplug());
  camera_.order({.kind = DslrFaultKind::kReset, .operation = Operation::kGetStorageIds});
  usb_.bulkOut(command(Operation::kGetStorageIds, 4));
  EXPECT_EQ(usb_.bulkIn(512)->kind, UsbTransfer::kGone);
  EXPECT_TRUE(usb_.wantsUnplug());
}

TEST_F(UsbPtpTest, AnswersTheRequestsOfItsClass) {
  EXPECT_EQ(usb_.control(bytes({0xA1, 0x67, 0, 0, 0, 0, 4, 0}), {}).bytes,
            bytes({4, 0, 0x01, 0x20}));
  usb_.bulkOut(command(Operation::kGetDeviceInfo, 7));
  EXPECT_EQ(usb_.control(bytes({0x21, 0x66, 0, 0, 0, 0, 0, 0}), {}).kind, UsbTransfer::kDone);
  EXPECT_FALSE(usb_.bulkIn(512));
  usb_.bulkOut(command(Operation::kGetStorageIds, 8));
  EXPECT_EQ(next(512), bytes({12, 0, 0, 0, 3, 0, 0x03, 0x20, 8, 0, 0, 0}));  // no session
  EXPECT_EQ(usb_.control(bytes({0x40, 1, 0, 0, 0, 0, 0, 0}), {}).kind, UsbTransfer::kStalledPipe);
}

TEST(UsbDescriptors, AreThoseOfAStillImageDevice) {
  const Bytes all = usbDescriptors({});
  ASSERT_EQ(all.size(), 18u + 39);
  EXPECT_EQ(all[0], std::byte{18});
  EXPECT_EQ(PtpReader(std::span(all).subspan(20, 2)).u16(), 39);
  EXPECT_EQ(Bytes(all.begin() + 32, all.begin() + 35), bytes({6, 1, 1}));
}

TEST(UsbDescriptors, NameTheSerial) {
  UsbIdentity who;
  who.serial = "7A";
  EXPECT_EQ(textDescriptor(who, bytes({0x80, 6, 3, 3, 9, 4, 255, 0})),
            bytes({6, 3, '7', 0, 'A', 0}));
  EXPECT_FALSE(textDescriptor(who, bytes({0x80, 0, 3, 3, 0, 0, 2, 0})));
}

}  // namespace
}  // namespace patina::testing
