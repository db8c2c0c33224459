// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/messages.h"

namespace patina::devices::host {
namespace {

enum class Kind : std::uint8_t { kHello = 1, kCall, kAnswer };

Writer begin(Kind kind) {
  Writer to;
  to.u8(static_cast<std::uint8_t>(kind));
  return to;
}

bool is(Reader& from, Kind kind) { return from.u8() == static_cast<std::uint8_t>(kind); }

auto damaged(const char* what) {
  return fail(Errc::kCorrupt, std::string("a damaged ") + what + " came over the connection");
}

void put(Writer& to, UtcTime v) { to.i64(toNs(v)); }
void get(Reader& from, UtcTime& v) { v = utcFromNs(from.i64()); }

// An enumeration whose last member is `last`; beyond it the message counts as damaged.
template <class E>
bool getEnum(Reader& from, E last, E& v) {
  const std::uint8_t number = from.u8();
  if (number > static_cast<std::uint8_t>(last)) return false;
  v = static_cast<E>(number);
  return true;
}

}  // namespace

const char* name(Op op) {
  switch (op) {
    case Op::kPing:
      return "ping";
    case Op::kConfigure:
      return "configure";
    case Op::kTrigger:
      return "trigger";
    case Op::kCollect:
      return "collect";
    case Op::kRelease:
      return "release";
    case Op::kPoll:
      return "poll";
    case Op::kRecover:
      return "recover";
    case Op::kSet:
      return "set";
    case Op::kIsOn:
      return "isOn";
    case Op::kRead:
      return "read";
    case Op::kFire:
      return "fire";
  }
  return "unknown";
}

Bytes encode(const Hello& hello) {
  Writer to = begin(Kind::kHello);
  to.u32(hello.protocol);
  to.text(hello.rig_toml);
  to.text(hello.rig_file);
  to.u32(static_cast<std::uint32_t>(hello.devices.size()));
  for (const std::string& id : hello.devices) to.text(id);
  to.u8(hello.told_time);
  to.u64(hello.seed);
  to.i64(hello.duration.count());
  put(to, hello.start_utc);
  to.u64(hello.memory_max_bytes);
  to.text(hello.find);
  return to.take();
}

Result<Hello> decodeHello(std::span<const std::byte> message) {
  Reader from(message);
  Hello hello;
  if (!is(from, Kind::kHello)) return damaged("greeting");
  hello.protocol = from.u32();
  if (from.ok() && hello.protocol != kProtocol)
    return fail(Errc::kUnsupported, "the two machines run Patinas of different protocols (" +
                                        std::to_string(hello.protocol) + " and " +
                                        std::to_string(kProtocol) + "): install the same version");
  hello.rig_toml = from.text();
  hello.rig_file = from.text();
  for (std::uint32_t left = from.u32(); left > 0 && from.ok(); --left)
    hello.devices.push_back(from.text());
  hello.told_time = from.flag();
  hello.seed = from.u64();
  hello.duration = Nanoseconds(from.i64());
  get(from, hello.start_utc);
  hello.memory_max_bytes = from.u64();
  hello.find = from.text();
  if (!from.whole()) return damaged("greeting");
  return hello;
}

Bytes encode(const Call& call) {
  Writer to = begin(Kind::kCall);
  to.u32(call.number);
  to.u16(call.device);
  to.u8(static_cast<std::uint8_t>(call.op));
  put(to, call.utc);
  put(to, call.mono);
  to.bytes(call.body);
  return to.take();
}

Result<Call> decodeCall(std::span<const std::byte> message) {
  Reader from(message);
  Call call;
  if (!is(from, Kind::kCall)) return damaged("call");
  call.number = from.u32();
  call.device = from.u16();
  if (!getEnum(from, Op::kFire, call.op)) return damaged("call");
  get(from, call.utc);
  get(from, call.mono);
  call.body = from.bytes();
  if (!from.whole()) return damaged("call");
  return call;
}

Bytes encode(const Answer& answer) {
  Writer to = begin(Kind::kAnswer);
  to.u32(answer.number);
  to.u8(static_cast<std::uint8_t>(answer.kind));
  put(to, answer.utc);
  put(to, answer.mono);
  to.u64(answer.memory_bytes);
  to.bytes(answer.body);
  return to.take();
}

Result<Answer> decodeAnswer(std::span<const std::byte> message) {
  Reader from(message);
  Answer answer;
  if (!is(from, Kind::kAnswer)) return damaged("answer");
  answer.number = from.u32();
  if (!getEnum(from, AnswerKind::kFailed, answer.kind)) return damaged("answer");
  get(from, answer.utc);
  get(from, answer.mono);
  answer.memory_bytes = from.u64();
  answer.body = from.bytes();
  if (!from.whole()) return damaged("answer");
  return answer;
}

void put(Writer& to, const Error& v) {
  to.u8(static_cast<std::uint8_t>(v.code));
  to.text(v.what);
}
void get(Reader& from, Error& v) {
  if (!getEnum(from, Errc::kRefused, v.code)) v.code = Errc::kCorrupt;
  v.what = from.text();
}

void put(Writer& to, MonoTime v) { to.i64(toNs(v)); }
void get(Reader& from, MonoTime& v) { v = monoFromNs(from.i64()); }

void put(Writer& to, const CameraEvent& v) { to.text(v.what); }
void get(Reader& from, CameraEvent& v) { v.what = from.text(); }

void put(Writer& to, const std::optional<bool>& v) {
  to.u8(v.has_value());
  to.u8(v.value_or(false));
}
void get(Reader& from, std::optional<bool>& v) {
  const bool known = from.flag();
  const bool is = from.flag();
  v = known ? std::optional(is) : std::nullopt;
}

void put(Writer& to, const Exposure& v) {
  to.i64(v.time.count());
  to.f64(v.iso.value);
  to.f64(v.f_number.value);
}
void get(Reader& from, Exposure& v) {
  v.time = Nanoseconds(from.i64());
  v.iso.value = from.f64();
  v.f_number.value = from.f64();
}

void put(Writer& to, const ShotRequest& v) {
  to.text(v.key);
  to.u64(v.sequence);
}
void get(Reader& from, ShotRequest& v) {
  v.key = from.text();
  v.sequence = from.u64();
}

void put(Writer& to, const Ticket& v) {
  to.text(v.key);
  to.u64(v.sequence);
  put(to, v.began_utc);
  put(to, v.began_mono);
}
void get(Reader& from, Ticket& v) {
  v.key = from.text();
  v.sequence = from.u64();
  get(from, v.began_utc);
  get(from, v.began_mono);
}

void put(Writer& to, const RawFrame& v) {
  to.i64(v.file_index);
  to.text(v.ext);
  to.bytes(v.bytes);
  to.u64(v.sequence);
  to.u8(v.declared_bytes.has_value());
  to.i64(v.declared_bytes.value_or(0));
  put(to, v.utc);
  put(to, v.mono);
  to.text(v.card_handle);
}
void get(Reader& from, RawFrame& v) {
  v.file_index = static_cast<int>(from.i64());
  v.ext = from.text();
  v.bytes = from.bytes();
  v.sequence = from.u64();
  const bool declared = from.flag();
  const std::int64_t bytes = from.i64();
  if (declared) v.declared_bytes = bytes;
  get(from, v.utc);
  get(from, v.mono);
  v.card_handle = from.text();
}

void put(Writer& to, const Seen& v) {
  to.text(v.refused);
  to.i64(v.size.width);
  to.i64(v.size.height);
  to.i64(v.bits);
  to.bytes(v.thumbnail);
}
void get(Reader& from, Seen& v) {
  v.refused = from.text();
  v.size.width = static_cast<int>(from.i64());
  v.size.height = static_cast<int>(from.i64());
  v.bits = static_cast<int>(from.i64());
  v.thumbnail = from.bytes();
}

void put(Writer& to, const Reading& v) {
  to.f64(v.value);
  put(to, v.utc);
  put(to, v.mono);
  to.u8(v.saturated);
}
void get(Reader& from, Reading& v) {
  v.value = from.f64();
  get(from, v.utc);
  get(from, v.mono);
  v.saturated = from.flag();
}

void put(Writer& to, const std::string& v) { to.text(v); }
void get(Reader& from, std::string& v) { v = from.text(); }

template <class A, class B>
void put(Writer& to, const std::pair<A, B>& v) {
  put(to, v.first);
  put(to, v.second);
}
template <class A, class B>
void get(Reader& from, std::pair<A, B>& v) {
  get(from, v.first);
  get(from, v.second);
}

void put(Writer& to, const Trouble& v) {
  to.u8(v.fatal);
  to.text(v.what);
  to.text(v.do_this);
}
void get(Reader& from, Trouble& v) {
  v.fatal = from.flag();
  v.what = from.text();
  v.do_this = from.text();
}

void put(Writer& to, const FoundDevice& v) {
  for (const std::string* text : {&v.kind, &v.backend, &v.model, &v.serial, &v.address, &v.state})
    to.text(*text);
  put(to, v.facts);
  put(to, v.choices);
  put(to, v.troubles);
}
void get(Reader& from, FoundDevice& v) {
  for (std::string* text : {&v.kind, &v.backend, &v.model, &v.serial, &v.address, &v.state})
    *text = from.text();
  get(from, v.facts);
  get(from, v.choices);
  get(from, v.troubles);
}

}  // namespace patina::devices::host
