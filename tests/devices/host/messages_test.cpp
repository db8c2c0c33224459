// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/matchers.h"

namespace patina::devices::host {
namespace {

using patina::testing::Fails;
using ::testing::HasSubstr;

template <class T>
T roundTrip(const T& value) {
  const Bytes body = bodyOf(value);
  Reader from(body);
  T back{};
  get(from, back);
  EXPECT_TRUE(from.whole());
  return back;
}

TEST(Messages, AHelloNamesTheRigAndItsDevices) {
  Hello hello;
  hello.rig_toml = "name = \"bench\"";
  hello.rig_file = "/lab/rig.toml";
  hello.devices = {"cam0", "key"};
  hello.told_time = true;
  hello.seed = 7;
  hello.start_utc = utcFromNs(5);
  const auto back = decodeHello(encode(hello));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->rig_toml, hello.rig_toml);
  EXPECT_EQ(back->rig_file, hello.rig_file);
  EXPECT_EQ(back->devices, hello.devices);
  EXPECT_TRUE(back->told_time);
  EXPECT_EQ(back->seed, 7u);
  EXPECT_EQ(back->start_utc, utcFromNs(5));
}

TEST(Messages, AnotherProtocolIsRefusedWithWhatToDo) {
  Hello hello;
  hello.protocol = kProtocol + 1;
  const auto back = decodeHello(encode(hello));
  EXPECT_THAT(back, Fails(Errc::kUnsupported));
  EXPECT_THAT(back.error().what, HasSubstr("install the same version"));
}

TEST(Messages, AFrameComesBackWithAllItsFields) {
  RawFrame frame;
  frame.file_index = 1;
  frame.ext = "nef";
  frame.bytes = Bytes(1000, std::byte{3});
  frame.sequence = 12;
  frame.declared_bytes = 1001;
  frame.utc = utcFromNs(77);
  frame.mono = monoFromNs(78);
  frame.card_handle = "/store_1/DSC_1.NEF";
  const RawFrame back = roundTrip(frame);
  EXPECT_EQ(back.file_index, 1);
  EXPECT_EQ(back.ext, "nef");
  EXPECT_EQ(back.bytes, frame.bytes);
  EXPECT_EQ(back.sequence, 12u);
  EXPECT_EQ(back.declared_bytes, 1001);
  EXPECT_EQ(back.utc, utcFromNs(77));
  EXPECT_EQ(back.mono, monoFromNs(78));
  EXPECT_EQ(back.card_handle, frame.card_handle);
  frame.declared_bytes.reset();
  EXPECT_FALSE(roundTrip(frame).declared_bytes.has_value());
}

TEST(Messages, ALampThatCannotTellSaysSo) {
  EXPECT_EQ(roundTrip(std::optional<bool>()), std::nullopt);
  EXPECT_EQ(roundTrip(std::optional<bool>(false)), false);
  EXPECT_EQ(roundTrip(std::optional<bool>(true)), true);
}

TEST(Messages, ErrorsAndExposuresComeBack) {
  const Error back = roundTrip(Error{Errc::kUnsupported, "no ISO 75"});
  EXPECT_EQ(back.code, Errc::kUnsupported);
  EXPECT_EQ(back.what, "no ISO 75");
  const Exposure exposure{Nanoseconds(5'000'000), {200}, {5.6}};
  EXPECT_EQ(roundTrip(exposure), exposure);
}

TEST(Messages, EveryCutOfAMessageIsDamaged) {
  Call call;
  call.number = 3;
  call.op = Op::kTrigger;
  call.body = bodyOf(ShotRequest{"run/1", 4});
  const Bytes whole = encode(call);
  ASSERT_TRUE(decodeCall(whole));
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THAT(decodeCall(std::span(whole).first(size)), Fails(Errc::kCorrupt)) << size;
  Bytes longer = whole;
  longer.push_back(std::byte{0});
  EXPECT_THAT(decodeCall(longer), Fails(Errc::kCorrupt));
  EXPECT_THAT(decodeAnswer(whole), Fails(Errc::kCorrupt));
}

TEST(Messages, AListCannotClaimMoreThanThereIs) {
  Writer to;
  to.u32(4'000'000'000);
  const Bytes body = to.take();
  Reader from(body);
  std::vector<RawFrame> frames;
  get(from, frames);
  EXPECT_FALSE(from.whole());
  EXPECT_LE(frames.size(), 1u);
}

}  // namespace
}  // namespace patina::devices::host
