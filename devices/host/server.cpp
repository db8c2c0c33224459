// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/server.h"

#include <poll.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdio>
#include <new>
#include <thread>

#include "devices/host/see.h"
#include "processing/image/failure.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kBeat = 500ms;
constexpr Nanoseconds kGrace = 2s;       // of a driver that hangs when its parent is gone
constexpr Nanoseconds kSendLimit = 30s;  // of an answer that nobody takes

std::uint64_t residentBytes() {
  std::FILE* file = std::fopen("/proc/self/statm", "re");
  if (!file) return 0;
  unsigned long long total = 0, resident = 0;
  const int fields = std::fscanf(file, "%llu %llu", &total, &resident);
  std::fclose(file);
  return fields == 2 ? resident * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE)) : 0;
}

// AddressSanitizer reserves terabytes of addresses.
void limitMemory([[maybe_unused]] std::uint64_t bytes) {
#ifndef __SANITIZE_ADDRESS__
  const rlimit limit{bytes, bytes};
  if (bytes > 0) setrlimit(RLIMIT_AS, &limit);
#endif
}

Answer answerTo(const Call& call, AnswerKind kind, const Clock& clock, Bytes body) {
  return {call.number, kind, clock.utc(), clock.mono(), residentBytes(), std::move(body)};
}

// Says that a call is under way, and ends the process when its parent has gone and it hangs.
class Beat {
 public:
  explicit Beat(Channel& channel)
      : channel_(channel), thread_([this](const std::stop_token& stop) { run(stop); }) {}

  // 0: no call is under way.
  void during(std::uint32_t call) {
    const std::lock_guard lock(mutex_);
    call_ = call;
  }

 private:
  void run(const std::stop_token& stop) {
    MonoTime alone_since{};
    while (clock_.sleepUntil(clock_.mono() + kBeat, stop) == Wake::kDue) {
      pollfd parent{channel_.fd(), POLLRDHUP, 0};
      const bool gone = poll(&parent, 1, 0) > 0;
      if (!gone)
        alone_since = {};
      else if (alone_since == MonoTime{})
        alone_since = clock_.mono();
      else if (clock_.mono() - alone_since > kGrace)
        _exit(0);
      const std::lock_guard lock(mutex_);
      if (call_ == 0 || gone) continue;
      Call call;
      call.number = call_;
      static_cast<void>(channel_.send(encode(answerTo(call, AnswerKind::kBeat, clock_, {})),
                                      clock_.mono() + kBeat));
    }
  }

  Channel& channel_;
  RealClock clock_;
  std::mutex mutex_;  // guards call_: after during(0) no beat of that call is sent any more
  std::uint32_t call_ = 0;
  std::jthread thread_;
};

template <class T>
Result<Bytes> bodied(const Result<T>& result) {
  if (!result) return tl::make_unexpected(result.error());
  if constexpr (std::is_void_v<T>)
    return Bytes{};
  else
    return bodyOf(*result);
}

// One device, of whichever kind.
struct Served {
  Camera* camera = nullptr;
  Light* light = nullptr;
  Sensor* sensor = nullptr;
  Trigger* trigger = nullptr;
};

auto damaged() { return fail(Errc::kCorrupt, "a damaged call came over the connection"); }

template <class T>
bool take(const Call& call, T& value) {
  Reader from(call.body);
  get(from, value);
  return from.whole();
}

Result<Bytes> recoverDevice(const Served& device, const Call& call) {
  if (device.light) return bodied(device.light->recover());
  if (device.sensor) return bodied(device.sensor->recover());
  if (device.trigger) return bodied(device.trigger->recover());
  Reader from(call.body);
  const std::uint8_t rung = from.u8();
  if (!from.whole() || rung > static_cast<std::uint8_t>(Rung::kPowerCycle)) return damaged();
  return bodied(device.camera->recover(static_cast<Rung>(rung)));
}

Result<Bytes> callCamera(Camera& camera, const Call& call) {
  if (call.op == Op::kConfigure) {
    Exposure exposure;
    if (!take(call, exposure)) return damaged();
    const auto applied = camera.configure(exposure);
    if (!applied) return tl::make_unexpected(applied.error());
    return bodyOf(applied->exposure);
  }
  if (call.op == Op::kTrigger) {
    ShotRequest request;
    return take(call, request) ? bodied(camera.trigger(request)) : damaged();
  }
  if (call.op == Op::kRelease) {
    RawFrame frame;
    return take(call, frame) ? bodied(camera.release(frame)) : damaged();
  }
  if (call.op == Op::kPoll) return bodied(camera.poll());
  return fail(Errc::kUnsupported, std::string(name(call.op)) + ": not a call of a camera");
}

Result<Bytes> callDevice(const Served& device, const Call& call) {
  if (call.op == Op::kPing) return Bytes{};
  if (call.op == Op::kRecover) return recoverDevice(device, call);
  if (device.camera) return callCamera(*device.camera, call);
  if (device.light && call.op == Op::kSet) {
    Reader from(call.body);
    const double level = from.f64();
    return from.whole() ? bodied(device.light->set(level)) : damaged();
  }
  if (device.light && call.op == Op::kIsOn) return bodied(device.light->isOn());
  if (device.sensor && call.op == Op::kRead) return bodied(device.sensor->read());
  if (device.trigger && call.op == Op::kFire) return bodied(device.trigger->fire());
  return fail(Errc::kUnsupported, std::string(name(call.op)) + ": not a call of this device");
}

class Server {
 public:
  Server(Channel& channel, const Hello& hello, const DeviceMaker& make)
      : channel_(channel), told_(hello.start_utc, MonoTime{}), is_told_(hello.told_time) {
    rig_ = make(hello, clock());
    for (const std::string& id : hello.devices) devices_.push_back(find(id));
    if (!is_told_) beat_.emplace(channel);
  }

  // Makes the call and answers it; false: nobody takes the answer.
  bool answer(const Call& call) {
    if (is_told_) told_.advance(std::max(call.mono - told_.mono(), Nanoseconds(0)));
    if (is_told_) told_.stepUtc(call.utc - told_.utc());
    if (beat_) beat_->during(call.number);
    const auto result = made(call);
    if (beat_) beat_->during(0);
    return send(result ? answerTo(call, AnswerKind::kDone, clock(), *result)
                       : answerTo(call, AnswerKind::kFailed, clock(), bodyOf(result.error())));
  }

 private:
  Clock& clock() { return is_told_ ? static_cast<Clock&>(told_) : real_; }
  bool send(const Answer& answer) {
    return channel_.send(encode(answer), real_.mono() + kSendLimit).has_value();
  }

  Served find(const std::string& id) {
    Served found;
    for (const auto& d : rig_.cameras)
      if (d->caps().id == id) found.camera = d.get();
    for (const auto& d : rig_.lights)
      if (d->caps().id == id) found.light = d.get();
    for (const auto& d : rig_.sensors)
      if (d->caps().id == id) found.sensor = d.get();
    for (const auto& d : rig_.triggers)
      if (d->id() == id) found.trigger = d.get();
    if (!found.camera && !found.light && !found.sensor && !found.trigger)
      throw Failure(Exit::kConfig, "no device '" + id + "' in the rig");
    return found;
  }

  Result<Bytes> made(const Call& call) {
    if (call.device >= devices_.size()) return damaged();
    const Served& device = devices_[call.device];
    try {
      if (device.camera && call.op == Op::kCollect) return collect(*device.camera, call);
      return callDevice(device, call);
    } catch (const std::bad_alloc&) {
      return fail(Errc::kCorrupt, "its driver's process has no memory left");
    } catch (const std::exception& error) {
      return fail(Errc::kLost, std::string("its driver threw: ") + error.what());
    }
  }

  // The files go out before they are decoded: whatever a decoder does, they are there.
  Result<Bytes> collect(Camera& camera, const Call& call) {
    Reader from(call.body);
    Ticket ticket;
    get(from, ticket);
    const Nanoseconds limit(from.i64());
    if (!from.whole()) return damaged();
    auto frames = camera.collect(ticket, clock().mono() + limit);
    if (!frames) return tl::make_unexpected(frames.error());
    if (!send(answerTo(call, AnswerKind::kPart, clock(), bodyOf(*frames))))
      return fail(Errc::kLost, "nobody takes the picture");
    std::vector<Seen> seen;
    for (const RawFrame& frame : *frames) seen.push_back(see(frame.bytes));
    return bodyOf(seen);
  }

  Channel& channel_;
  RealClock real_;
  VirtualClock told_;
  bool is_told_;
  Rig rig_;
  std::vector<Served> devices_;
  std::optional<Beat> beat_;  // last: its thread ends first
};

}  // namespace

void serve(Channel& channel, const DeviceMaker& make, const DeviceFinder& find,
           std::optional<Nanoseconds> silence_max) {
  const RealClock clock;
  const auto first = channel.receive(clock.mono() + 10s);
  if (!first) return;
  const auto hello = decodeHello(*first);
  const Call greeting;
  const auto refuse = [&](const Error& error) {
    static_cast<void>(
        channel.send(encode(answerTo(greeting, AnswerKind::kFailed, clock, bodyOf(error))),
                     clock.mono() + kSendLimit));
  };
  if (!hello) return refuse(hello.error());
  limitMemory(hello->memory_max_bytes);
  std::optional<Server> server;
  Bytes found;
  try {
    if (!hello->find.empty() && find) found = bodyOf(find(hello->find));
    if (hello->find.empty()) server.emplace(channel, *hello, make);
  } catch (const std::exception& error) {
    return refuse({Errc::kUnsupported, error.what()});
  }
  if (!channel.send(encode(answerTo(greeting, AnswerKind::kDone, clock, std::move(found))),
                    clock.mono() + kSendLimit) ||
      !server)
    return;
  while (true) {
    const auto message = channel.receive(clock.mono() + silence_max.value_or(1h));
    if (!message && message.error().code == Errc::kTimeout && !silence_max) continue;
    if (!message) return;
    const auto call = decodeCall(*message);
    if (!call || !server->answer(*call)) return;
  }
}

}  // namespace patina::devices::host
