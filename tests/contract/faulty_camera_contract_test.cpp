// SPDX-License-Identifier: GPL-3.0-or-later
// A camera in trouble keeps the same contract: whatever goes wrong and whatever it is asked, its
// states stay those of devices/camera.h, and it comes back. Random walks, seeded.
#include <gmock/gmock.h>

#include <optional>

#include "processing/image/random.h"
#include "tests/contract/backends.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;

constexpr FaultKind kCameraKinds[] = {
    FaultKind::kHang,        FaultKind::kBusy,      FaultKind::kLost,
    FaultKind::kPartialFile, FaultKind::kDuplicate, FaultKind::kLate,
    FaultKind::kStaleFrame,  FaultKind::kWrongSize, FaultKind::kCorruptBytes};
constexpr Rung kRungs[] = {Rung::kRetry, Rung::kDrain, Rung::kReopen, Rung::kReset,
                           Rung::kPowerCycle};

FaultPlan planOf(std::uint64_t seed) {
  FaultPlan plan;
  plan.seed = seed;
  for (std::uint64_t i = 0; i < 30; ++i) {
    Fault fault;
    fault.at = std::chrono::seconds(uniformBelow(hashSeed(seed, 1, i), 3600));
    fault.device = "cam0";
    fault.kind = kCameraKinds[uniformBelow(hashSeed(seed, 2, i), std::size(kCameraKinds))];
    const bool one_call = uniform(hashSeed(seed, 3, i)) < 0.5;
    fault.duration = std::chrono::seconds(one_call ? 0 : uniformBelow(hashSeed(seed, 4, i), 120));
    plan.faults.push_back(fault);
  }
  return plan;
}

// The states of the contract, followed from outside by the answers alone.
class Walker {
 public:
  Walker(RigUnderTest& made, std::uint64_t seed)
      : clock_(*made.clock), camera_(*made.rig.cameras.at(0)), seed_(seed) {}

  void step() {
    clock_.advance(std::chrono::milliseconds(random(6000)));
    const bool sensible = random(100) < 70;
    const int call = sensible ? nextSensible() : static_cast<int>(random(6));
    const MonoTime before = clock_.mono();
    Nanoseconds allowed = camera_.caps().cycle + 10s;
    switch (call) {
      case 0:
        judge(camera_.configure(Exposure{}), state_ == State::kReady, {Errc::kRefused});
        break;
      case 1:
        trigger();
        break;
      case 2:
        allowed = std::chrono::milliseconds(random(3000));
        collect(before + allowed);
        break;
      case 3:
        judge(camera_.poll(), state_ == State::kReady, {Errc::kRefused});
        break;
      case 4:
        judge(camera_.release(RawFrame{}), state_ == State::kReady, {Errc::kRefused});
        break;
      default:
        recover(kRungs[random(std::size(kRungs))]);
    }
    EXPECT_LE(clock_.mono() - before, allowed) << "call " << call;
  }

  int pictures() const { return pictures_; }

 private:
  enum class State { kClosed, kReady, kArmed, kUnknown, kLost };

  std::uint64_t random(std::uint64_t below) {
    return uniformBelow(hashSeed(seed_, ++draws_), below);
  }
  int nextSensible() const { return state_ == State::kReady ? 1 : state_ == State::kArmed ? 2 : 5; }

  // `may_pass`: the state allows the call. Loss may come at any time and then stays.
  template <class T>
  void judge(const Result<T>& answer, bool may_pass, std::vector<Errc> failures) {
    if (answer) {
      EXPECT_TRUE(may_pass) << "passed in state " << static_cast<int>(state_);
      return;
    }
    const Errc code = answer.error().code;
    if (code == Errc::kLost) {
      state_ = State::kLost;
      return;
    }
    EXPECT_NE(state_, State::kLost) << answer.error().what;
    if (state_ == State::kUnknown) failures.push_back(Errc::kTimeout);
    EXPECT_THAT(failures, ::testing::Contains(code)) << answer.error().what;
    EXPECT_TRUE(!may_pass || code != Errc::kRefused) << answer.error().what;
  }

  void trigger() {
    const ShotRequest request{"shot/" + std::to_string(++sequence_), sequence_};
    const auto ticket = camera_.trigger(request);
    judge(ticket, state_ == State::kReady, {Errc::kRefused, Errc::kBusy});
    if (ticket) {
      EXPECT_EQ(ticket->key, request.key);
      state_ = State::kArmed;
      ticket_ = *ticket;
    }
  }

  void collect(MonoTime deadline) {
    const auto frames = camera_.collect(ticket_, deadline);
    judge(frames, state_ == State::kArmed, {Errc::kRefused, Errc::kTimeout});
    if (!frames) {
      if (frames.error().code == Errc::kTimeout) state_ = State::kUnknown;
      return;
    }
    state_ = State::kReady;
    ++pictures_;
    std::size_t own = 0;
    for (const RawFrame& frame : *frames) own += frame.sequence == ticket_.sequence;
    EXPECT_GE(own, camera_.caps().extensions.size());
  }

  void recover(Rung rung) {
    const auto answer = camera_.recover(rung);
    judge(answer, true, {Errc::kTimeout});
    if (answer) state_ = State::kReady;
  }

  VirtualClock& clock_;
  Camera& camera_;
  std::uint64_t seed_, draws_ = 0, sequence_ = 0;
  State state_ = State::kClosed;
  Ticket ticket_;
  int pictures_ = 0;
};

class FaultyCameraContract : public ::testing::TestWithParam<Backend> {};

TEST_P(FaultyCameraContract, KeepsItsStatesInAnyTroubleAndComesBack) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RigUnderTest made = makeWithFaults(GetParam(), planOf(seed));
    const MonoTime end = made.clock->mono() + 1h;
    Walker walker(made, seed);
    while (made.clock->mono() < end && !HasFailure()) walker.step();
    EXPECT_GT(walker.pictures(), 10);

    Camera& camera = *made.rig.cameras.at(0);
    made.clock->advance(1h);
    for (int i = 0; i < 40 && !camera.recover(Rung::kPowerCycle); ++i) continue;
    // What is left are faults of one call that met no such call yet.
    bool clean = false;
    for (std::uint64_t shot = 1; shot <= 20 && !clean; ++shot) {
      const auto ticket = camera.trigger({"last/" + std::to_string(shot), 100'000 + shot});
      auto frames = ticket ? camera.collect(*ticket, made.clock->mono() + 1min)
                           : Result<std::vector<RawFrame>>(fail(Errc::kBusy, "not yet"));
      if (!frames && !camera.recover(Rung::kPowerCycle)) continue;
      clean = frames && frames->size() == camera.caps().extensions.size() &&
              frames->front().sequence == 100'000 + shot;
    }
    EXPECT_TRUE(clean);
  }
}

TEST_P(FaultyCameraContract, TheSamePlanGivesTheSameTroubleTwice) {
  const auto run = [&] {
    RigUnderTest made = makeWithFaults(GetParam(), planOf(11));
    Camera& camera = *made.rig.cameras.at(0);
    std::string log;
    for (std::uint64_t shot = 1; shot <= 120; ++shot) {
      made.clock->advance(30s);
      if (!camera.recover(Rung::kReset)) log += "r ";
      const auto ticket = camera.trigger({std::to_string(shot), shot});
      if (!ticket) {
        log += name(ticket.error().code) + std::string(" ");
        continue;
      }
      const auto frames = camera.collect(*ticket, made.clock->mono() + 5s);
      if (!frames) log += name(frames.error().code) + std::string(" ");
      for (const RawFrame& frame : frames ? *frames : std::vector<RawFrame>{}) {
        std::uint64_t hash = frame.sequence;
        for (const std::byte b : frame.bytes) hash = hashSeed(hash, std::to_integer<unsigned>(b));
        log += std::to_string(hash) + " ";
      }
    }
    return log;
  };
  const std::string first = run();
  EXPECT_THAT(first, ::testing::HasSubstr("timeout"));
  EXPECT_EQ(run(), first);
}

INSTANTIATE_TEST_SUITE_P(Backends, FaultyCameraContract, ::testing::ValuesIn(bareBackends()),
                         backendName);

}  // namespace
}  // namespace patina::testing
