// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/driver_link.h"

#include <algorithm>

#include "devices/host/dial.h"
#include "devices/host/seal.h"
#include "processing/image/failure.h"

namespace patina::devices::host {
namespace {

using namespace std::chrono_literals;

constexpr int kStartsAtOnce = 3;
constexpr Nanoseconds kStartDistanceMax = 60s;

Nanoseconds distance(int starts) {
  if (starts < kStartsAtOnce) return {};
  return std::min<Nanoseconds>(1s * (1 << std::min(starts - kStartsAtOnce, 6)), kStartDistanceMax);
}

}  // namespace

DriverLink::DriverLink(LinkOptions options, Clock& clock)
    : options_(std::move(options)), clock_(clock) {
  if (options_.remote && clock_.threadSafe())
    asking_ = std::jthread([this](const std::stop_token& stop) { keepAsking(stop); });
}

DriverLink::~DriverLink() { stop(); }

Error DriverLink::named(Error error) const {
  error.what = options_.name + ": " + error.what;
  return error;
}

void DriverLink::drop(bool by_force) {
  if (by_force && process_) process_->kill();
  channel_.reset();  // the process sees it and closes its devices
  process_.reset();
  running_ = false;
}

// A link that was cut without a word is found between calls too, and the host's side, which waits
// for calls, knows by this that its caller lives.
void DriverLink::keepAsking(const std::stop_token& stop) {
  while (real_.sleepUntil(real_.mono() + options_.ask_every, stop) == Wake::kDue) {
    if (!running_) continue;
    const auto there = call(0, Op::kPing, {}, options_.silence_max);
    const std::lock_guard lock(mutex_);
    if (!there && !running_) ended_by_ = there.error().what;
  }
}

void DriverLink::stop() {
  const std::lock_guard lock(mutex_);
  drop(false);
}

Result<void> DriverLink::start() {
  const std::lock_guard lock(mutex_);
  if (running_) return {};
  const MonoTime now = real_.mono();
  const Nanoseconds wait = last_start_ + distance(starts_) - now;
  if (starts_ > 0 && wait > 0ns) {
    const auto whole = std::chrono::ceil<std::chrono::seconds>(wait);
    return tl::make_unexpected(
        named({Errc::kLost, "started " + std::to_string(starts_) + " times for nothing; again in " +
                                formatDuration(whole)}));
  }
  last_start_ = now;
  ++starts_;
  ++start_count_;
  auto greeted = connect();
  if (greeted) greeted = greet(now + options_.start_limit);
  if (!greeted) {
    drop(true);
    return tl::make_unexpected(named(greeted.error()));
  }
  if (!options_.hello.told_time) channel_->limitSilence(options_.silence_max);
  ended_by_.clear();
  running_ = true;
  return {};
}

Result<void> DriverLink::connect() {
  if (options_.remote) {
    auto stream = dial(options_.remote->address, real_.mono() + options_.start_limit);
    if (!stream) return tl::make_unexpected(stream.error());
    channel_ = std::make_unique<Channel>(std::move(*stream));
    try {
      return greetAsCaller(*channel_, readKey(options_.remote->key),
                           real_.mono() + options_.start_limit);
    } catch (const Failure& failure) {
      return fail(Errc::kRefused, failure.what());
    }
  }
  if (!home_) {
    auto home = DriverHome::make();
    if (!home) return tl::make_unexpected(home.error());
    home_ = std::move(*home);
  }
  auto ends = makeChannelEnds();
  if (!ends) return tl::make_unexpected(ends.error());
  auto process = ChildProcess::start(options_.command, ends->theirs, home_);
  if (!process) return tl::make_unexpected(process.error());
  process_ = std::move(*process);
  channel_ = std::make_unique<Channel>(std::move(ends->ours));
  return {};
}

Result<void> DriverLink::greet(MonoTime deadline) {
  const MonoTime asked = real_.mono();
  if (auto sent = channel_->send(encode(options_.hello), deadline); !sent) return sent;
  const auto message = channel_->receive(deadline);
  if (!message) return tl::make_unexpected(message.error());
  const auto answer = decodeAnswer(*message);
  if (!answer) return tl::make_unexpected(answer.error());
  if (answer->kind == AnswerKind::kFailed) {
    Error error;
    Reader from(answer->body);
    get(from, error);
    return tl::make_unexpected(error);
  }
  if (!options_.remote) return {};
  // Halfway between question and answer: good to half of what they took.
  const MonoTime now = real_.mono();
  const Nanoseconds half = (now - asked) / 2;
  mono_offset_ = (now - half) - answer->mono;
  utc_offset_ = (real_.utc() - half) - answer->utc;
  return {};
}

Result<DriverLink::Reply> DriverLink::call(std::uint16_t device, Op op, const Bytes& body,
                                           Nanoseconds limit) {
  const std::lock_guard lock(mutex_);
  if (!running_)
    return tl::make_unexpected(
        named({Errc::kLost, std::string(name(op)) + ": is not running" +
                                (ended_by_.empty() ? "" : " since " + ended_by_)}));
  Call call;
  call.number = ++calls_;
  call.device = device;
  call.op = op;
  call.utc = clock_.utc();
  call.mono = clock_.mono();
  call.body = body;
  auto reply = exchange(call, real_.mono() + limit);
  if (reply && reply->cut) reply->cut = named(*reply->cut);
  if (!reply) {
    Error error = reply.error();
    error.what = std::string(name(op)) + ": " + error.what;
    return tl::make_unexpected(named(error));
  }
  return reply;
}

Result<DriverLink::Reply> DriverLink::exchange(const Call& call, MonoTime deadline) {
  Reply reply;
  const auto cut_off = [&](Error error) -> Result<Reply> {
    drop(true);
    if (!reply.part) return tl::make_unexpected(std::move(error));
    reply.cut = std::move(error);
    return std::move(reply);
  };
  if (auto sent = channel_->send(encode(call), deadline); !sent) return cut_off(sent.error());
  while (true) {
    const auto message = channel_->receive(deadline);
    if (!message) return cut_off(message.error());
    auto answer = decodeAnswer(*message);
    if (!answer) return cut_off(answer.error());
    memory_bytes_ = answer->memory_bytes;
    if (answer->number != call.number || answer->kind == AnswerKind::kBeat) continue;
    if (answer->kind == AnswerKind::kPart) {
      reply.part = std::move(answer->body);
      continue;
    }
    if (options_.hello.told_time) clock_.sleepUntil(answer->mono, {});
    if (answer->kind == AnswerKind::kDone) {
      reply.body = std::move(answer->body);
      return reply;
    }
    Error error;
    Reader from(answer->body);
    get(from, error);
    return tl::make_unexpected(error);
  }
}

Result<std::vector<FoundDevice>> findInProcess(const std::vector<std::string>& command,
                                               const std::string& backend, Nanoseconds limit) {
  const RealClock clock;
  const MonoTime deadline = clock.mono() + limit;
  auto ends = makeChannelEnds();
  if (!ends) return tl::make_unexpected(ends.error());
  auto process = ChildProcess::start(command, ends->theirs);
  if (!process) return tl::make_unexpected(process.error());
  ends->theirs = Descriptor();
  Channel channel(std::move(ends->ours));
  Hello hello;
  hello.find = backend;
  if (auto sent = channel.send(encode(hello), deadline); !sent)
    return tl::make_unexpected(sent.error());
  const auto message = channel.receive(deadline);
  if (!message) {
    (*process)->kill();
    return tl::make_unexpected(message.error());
  }
  const auto answer = decodeAnswer(*message);
  if (!answer) return tl::make_unexpected(answer.error());
  Reader from(answer->body);
  std::vector<FoundDevice> found;
  Error error;
  const bool failed = answer->kind == AnswerKind::kFailed;
  if (failed)
    get(from, error);
  else
    get(from, found);
  if (!from.whole()) return fail(Errc::kCorrupt, "a damaged list of devices came");
  if (failed) return tl::make_unexpected(std::move(error));
  return found;
}

}  // namespace patina::devices::host
