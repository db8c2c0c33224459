// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/picture_source.h"
#include "tests/support/loopback/snapshots.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using network::Fetched;
using ::testing::HasSubstr;

class SnapshotSource : public ::testing::Test {
 protected:
  void open() {
    settings_.who = "network 'cam0'";
    settings_.url = "http://" + server_.address() + "/snapshot.jpg";
    settings_.ext = "jpg";
    settings_.bytes_max = 100'000;
    settings_.connect_timeout = 5s;
    source_ = network::makeSnapshotSource(settings_, clock_);
    ASSERT_THAT(source_->open(clock_.mono() + 20s), IsOk());
  }
  Result<Fetched> fetch(Nanoseconds within = 20s) {
    return source_->fetch(clock_.mono(), clock_.mono() + within);
  }
  // Called on the server's thread; changed only while nobody asks.
  std::function<std::string()> answer = [this] { return ok(jpeg(++number)); };
  std::uint64_t number = 0;
  RealClock clock_;
  network::CameraSettings settings_;
  LoopbackServer server_{[this](Peer& peer) {
    peer.receiveHead();
    peer.send(answer());
  }};
  std::unique_ptr<network::PictureSource> source_;
};

TEST_F(SnapshotSource, ThePreviousPictureAgainIsAskedForUntilThereIsANewOne) {
  open();
  int asked = 0;
  answer = [&] { return ok(jpeg(++asked < 3 ? 1 : 2)); };
  EXPECT_THAT(fetch(), IsOk());
  EXPECT_EQ(asked, 3);
}

TEST_F(SnapshotSource, TheSamePictureForEverIsCorruptAtTheDeadline) {
  open();
  answer = [] { return ok(jpeg(1)); };
  const auto same = fetch(250ms);
  ASSERT_THAT(same, Fails(Errc::kCorrupt));
  EXPECT_THAT(same.error().what, HasSubstr("the previous picture came again"));
  answer = [] { return ok(jpeg(9)); };
  EXPECT_THAT(fetch(), IsOk());
}

TEST_F(SnapshotSource, APictureModifiedBeforeTheTriggerIsCorrupt) {
  const std::string dated = "Date: Wed, 01 May 2024 12:00:00 GMT\r\n";
  answer = [&] { return ok(jpeg(++number), dated); };
  open();
  answer = [&] {
    return ok(jpeg(++number), "Last-Modified: Wed, 01 May 2024 11:59:00 GMT\r\n" + dated);
  };
  EXPECT_THAT(fetch(250ms), Fails(Errc::kCorrupt));
}

TEST_F(SnapshotSource, APageOrAnotherFormatOrHalfAPictureIsCorrupt) {
  open();
  answer = [] { return ok("<html>login</html>", {}, "text/html"); };
  const auto page = fetch();
  ASSERT_THAT(page, Fails(Errc::kCorrupt));
  EXPECT_THAT(page.error().what, HasSubstr("text/html"));
  answer = [] { return ok("<html>login</html>", {}, "image/jpeg"); };
  EXPECT_THAT(fetch(), Fails(Errc::kCorrupt));
  answer = [] { return ok("\x89PNG\r\n\x1A\n", {}, "image/png"); };
  EXPECT_THAT(fetch(), Fails(Errc::kCorrupt));
  answer = [] { return ok(jpeg(5).substr(0, 200)); };
  EXPECT_THAT(fetch(), Fails(Errc::kCorrupt));
  answer = [] { return ok(jpeg(6)); };
  EXPECT_THAT(fetch(), IsOk());
}

TEST_F(SnapshotSource, AsksOnlyAfterTheLatency) {
  settings_.latency = 30ms;
  open();
  const MonoTime trigger = clock_.mono();
  const auto fetched = source_->fetch(trigger, trigger + 20s);
  ASSERT_THAT(fetched, IsOk());
  EXPECT_GE(fetched->taken, trigger + 30ms);
}

}  // namespace
}  // namespace patina::testing
