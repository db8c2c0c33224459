// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/ptpip_server.h"

#include <gtest/gtest.h>

#include "processing/image/random.h"
#include "processing/image/sha256.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/devices/twin/dslr/wire_client.h"

namespace patina::devices::twin::dslr {
namespace {

using namespace std::chrono_literals;

class PtpIpServerTest : public ::testing::Test {
 protected:
  int port() const { return server_.port(); }
  std::uint32_t shoot(WireClient& client) {
    EXPECT_EQ(client.ask(Operation::kInitiateCapture), Answer::kOk);
    return client.nextFile();
  }
  // A client that comes after one that the server may still have to bury.
  bool opensForANewClient() {
    for (int i = 0; i < 200; ++i) {
      if (WireClient(port()).is_open) return true;
      clock_.sleepUntil(clock_.mono() + 10ms, {});
    }
    return false;
  }

  RealClock clock_;
  Dslr camera_{dslrWorld(clock_), {.save = 1ms}};
  PtpIpServer server_{camera_};
};

TEST_F(PtpIpServerTest, CarriesAPictureByteForByte) {
  WireClient client(port());
  ASSERT_TRUE(client.is_open);
  const std::uint32_t file = shoot(client);
  ASSERT_EQ(client.ask(Operation::kGetObject, {file}), Answer::kOk);
  EXPECT_EQ(sha256(client.data), camera_.truth().pictures.at(0).files.at(0).hash);
}

TEST_F(PtpIpServerTest, ServesOneClientAtATimeAndTheNextWhenThatIsGone) {
  {
    const WireClient first(port());
    ASSERT_TRUE(first.is_open);
    RawConnection second(port());
    second.send(PacketType::kInitCommandRequest, Bytes(24));
    const auto refused = second.read();
    ASSERT_TRUE(refused);
    EXPECT_EQ(refused->type, PacketType::kInitFail);
  }
  EXPECT_TRUE(opensForANewClient());
}

TEST_F(PtpIpServerTest, TakesNoEventConnectionOfAnotherClient) {
  WireClient client(port());
  RawConnection stranger(port());
  stranger.send(PacketType::kInitEventRequest, Bytes(4, std::byte{99}));
  const auto refused = stranger.read();
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->type, PacketType::kInitFail);
  EXPECT_EQ(client.ask(Operation::kGetStorageIds), Answer::kOk);
}

TEST_F(PtpIpServerTest, AnswersProbes) {
  WireClient client(port());
  client.commands.send(PacketType::kProbeRequest, {});
  const auto answer = client.commands.read();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->type, PacketType::kProbeResponse);
}

TEST_F(PtpIpServerTest, ClosesTheConnectionOfGarbageAndServesOn) {
  for (std::uint64_t round = 0; round < 50; ++round) {
    RawConnection stranger(port());
    Bytes garbage(1 + uniformBelow(hashSeed(round), 300));
    for (std::size_t i = 0; i < garbage.size(); ++i)
      garbage[i] = static_cast<std::byte>(hashSeed(round, i) & 0xff);
    stranger.send(garbage);
  }
  EXPECT_TRUE(opensForANewClient());
}

TEST_F(PtpIpServerTest, ClosesAClientThatSaysWhatIsNoCommand) {
  for (const PacketType type :
       {PacketType::kStartData, PacketType::kInitCommandRequest, static_cast<PacketType>(77)}) {
    {
      WireClient client(port());
      ASSERT_TRUE(client.is_open);
      client.commands.send(type, Bytes(12));
      EXPECT_FALSE(client.answer());
    }
    EXPECT_TRUE(opensForANewClient());
  }
}

TEST_F(PtpIpServerTest, HasRoomForAClientWhileManyStrangersSayNothing) {
  std::vector<std::unique_ptr<RawConnection>> silent;
  for (int i = 0; i < 30; ++i) silent.push_back(std::make_unique<RawConnection>(port()));
  EXPECT_TRUE(opensForANewClient());
}

TEST_F(PtpIpServerTest, StallsInMidTransferAndGoesOn) {
  WireClient client(port());
  const std::uint32_t file = shoot(client);
  camera_.order({.kind = DslrFaultKind::kStall, .duration = 100ms, .amount = 0.5});
  const MonoTime begin = clock_.mono();
  ASSERT_EQ(client.ask(Operation::kGetObject, {file}), Answer::kOk);
  EXPECT_GE(clock_.mono() - begin, 100ms);
  EXPECT_EQ(sha256(client.data), camera_.truth().pictures.at(0).files.at(0).hash);
}

TEST_F(PtpIpServerTest, ServesANewClientWhileTheOldOneIsStalledForEver) {
  {
    WireClient client(port());
    camera_.order({.kind = DslrFaultKind::kStall, .operation = Operation::kGetStorageIds});
    client.send(Operation::kGetStorageIds);
    EXPECT_FALSE(client.answer(20));
    EXPECT_EQ(client.commands.error, EAGAIN);
  }
  EXPECT_TRUE(opensForANewClient());
}

TEST_F(PtpIpServerTest, ResetsAndClosesInMidTransfer) {
  for (const auto kind : {DslrFaultKind::kReset, DslrFaultKind::kClose}) {
    {
      WireClient client(port());
      ASSERT_TRUE(client.is_open);
      const std::uint32_t file = shoot(client);
      camera_.order({.kind = kind, .amount = 0.5});
      const std::size_t before = client.commands.received;
      EXPECT_FALSE(client.ask(Operation::kGetObject, {file}));
      const std::size_t bytes = client.commands.received - before;
      if (kind == DslrFaultKind::kClose) {
        EXPECT_EQ(client.commands.error, 0);
        EXPECT_GT(bytes, 100u);
      } else {
        EXPECT_EQ(client.commands.error, ECONNRESET);
      }
      EXPECT_LT(bytes, camera_.truth().pictures.back().files.at(0).bytes);
    }
    EXPECT_TRUE(opensForANewClient());
  }
}

TEST_F(PtpIpServerTest, CutsItsClientOffWhenThePowerGoesAndComesBack) {
  WireClient client(port());
  const std::uint32_t file = shoot(client);
  camera_.turnOff(50ms);
  EXPECT_FALSE(client.commands.read());
  EXPECT_NE(client.commands.error, EAGAIN);
  ASSERT_TRUE(opensForANewClient());
  WireClient again(port());
  for (int i = 0; i < 100 && !again.is_open; ++i) again = WireClient(port());
  EXPECT_EQ(again.ask(Operation::kGetObject, {file}), Answer::kOk);
}

TEST_F(PtpIpServerTest, TellsOfAPictureTakenByTheShutterLine) {
  WireClient client(port());
  ASSERT_TRUE(camera_.pressShutter());
  EXPECT_NE(client.nextFile(), 0u);
}

TEST_F(PtpIpServerTest, EndsAtOnceWhateverItsClientIsWaitingFor) {
  auto server = std::make_unique<PtpIpServer>(camera_);
  WireClient client(server->port());
  camera_.order({.kind = DslrFaultKind::kStall, .operation = Operation::kGetStorageIds});
  client.send(Operation::kGetStorageIds);
  server.reset();
  EXPECT_FALSE(client.answer());
  EXPECT_NE(client.commands.error, EAGAIN);
}

// A client of little patience that starts anew after every failure.
TEST_F(PtpIpServerTest, KeepsItsTruthThroughEveryKindOfTrouble) {
  constexpr int kPatienceMs = 30;
  camera_.misbehave(11, 0.08, 20ms);
  std::unique_ptr<WireClient> client;
  for (int shot = 0; shot < 150; ++shot) {
    for (int i = 0; i < 100 && !(client && client->is_open); ++i)
      client = std::make_unique<WireClient>(port());
    client->send(Operation::kInitiateCapture);
    bool good = client->answer(kPatienceMs) == Answer::kOk;
    const std::uint32_t file = good ? client->nextFile(kPatienceMs) : 0;
    for (const Operation operation : {Operation::kGetObject, Operation::kDeleteObject}) {
      if (!good || file == 0) break;
      client->send(operation, {file});
      good = client->answer(kPatienceMs) == Answer::kOk;
    }
    if (!good) client.reset();
  }
  client.reset();
  camera_.behave();
  ASSERT_TRUE(opensForANewClient());
  const Truth truth = camera_.truth();
  EXPECT_GT(truth.faults.size(), 20u);
  EXPECT_GT(truth.pictures.size(), 50u);
  WireClient last(port());
  for (int i = 0; i < 100 && !last.is_open; ++i) last = WireClient(port());
  for (const TruePicture& picture : truth.pictures)
    for (const TrueFile& file : picture.files) {
      const auto answer = last.ask(Operation::kGetObject, {file.handle});
      EXPECT_EQ(answer, file.deleted_utc ? Answer::kInvalidObjectHandle : Answer::kOk);
      EXPECT_TRUE(file.deleted_utc || sha256(last.data) == file.hash) << file.name;
    }
}

TEST(PtpIpServerAddress, IsRefusedWhenItIsNoneOrTaken) {
  RealClock clock;
  Dslr camera(dslrWorld(clock), {});
  EXPECT_THROW(PtpIpServer(camera, "localhost"), Failure);
  const PtpIpServer server(camera);
  Dslr other(dslrWorld(clock), {});
  EXPECT_THROW(PtpIpServer(other, "127.0.0.1", server.port()), Failure);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
