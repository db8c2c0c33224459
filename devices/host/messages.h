// SPDX-License-Identifier: GPL-3.0-or-later
// What a parent asks of the process that holds its devices, and what comes back.
//
// A call is answered by any number of beats ("still at it"), of parts (the files of a shot, before
// they are decoded), and one last answer, all with the call's number. Answers to calls that nobody
// waits for any more are thrown away by it.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "devices/camera.h"
#include "devices/found.h"
#include "devices/host/wire.h"
#include "devices/sensor.h"

namespace patina::devices::host {

inline constexpr std::uint32_t kProtocol = 2;

// The first message: which devices of which rig, or what a backend sees attached.
struct Hello {
  std::uint32_t protocol = kProtocol;
  std::string rig_toml, rig_file;
  std::vector<std::string> devices;  // ids; calls name them by their place here
  // Time is what each call says it is, and sleeping is advancing (VirtualClock); else the
  // machine's.
  bool told_time = false;
  std::uint64_t seed = 1;  // of a twin
  Nanoseconds duration{};
  UtcTime start_utc{};
  std::uint64_t memory_max_bytes = 0;  // 0: no limit
  std::string find;                    // a backend: its find() is the answer, and nothing is served
};

enum class Op : std::uint8_t {
  kPing,
  kConfigure,
  kTrigger,
  kCollect,
  kRelease,
  kPoll,
  kRecover,  // of any device; a rung for cameras
  kSet,
  kIsOn,
  kRead,
  kFire
};
const char* name(Op op);

struct Call {
  std::uint32_t number = 0;
  std::uint16_t device = 0;
  Op op = Op::kPing;
  UtcTime utc;  // now, for those who are told the time
  MonoTime mono;
  Bytes body;
};

enum class AnswerKind : std::uint8_t { kBeat, kPart, kDone, kFailed };
struct Answer {
  std::uint32_t number = 0;
  AnswerKind kind = AnswerKind::kDone;
  UtcTime utc;  // when it was sent, by the host's clock
  MonoTime mono;
  std::uint64_t memory_bytes = 0;  // the process's resident set
  Bytes body;                      // kFailed: an Error
};

Bytes encode(const Hello& hello);
Bytes encode(const Call& call);
Bytes encode(const Answer& answer);
// kCorrupt when a message is not whole or is of another kind.
Result<Hello> decodeHello(std::span<const std::byte> message);
Result<Call> decodeCall(std::span<const std::byte> message);
Result<Answer> decodeAnswer(std::span<const std::byte> message);

// The bodies. get() leaves it to reader.whole() whether all was there.
void put(Writer& to, const Error& v);
void put(Writer& to, const Exposure& v);
void put(Writer& to, const ShotRequest& v);
void put(Writer& to, const Ticket& v);
void put(Writer& to, const RawFrame& v);  // without `seen`
void put(Writer& to, const Seen& v);
void put(Writer& to, const Reading& v);
void put(Writer& to, const CameraEvent& v);
void put(Writer& to, const std::optional<bool>& v);
void put(Writer& to, MonoTime v);
void put(Writer& to, const FoundDevice& v);
void get(Reader& from, Error& v);
void get(Reader& from, Exposure& v);
void get(Reader& from, ShotRequest& v);
void get(Reader& from, Ticket& v);
void get(Reader& from, RawFrame& v);
void get(Reader& from, Seen& v);
void get(Reader& from, Reading& v);
void get(Reader& from, CameraEvent& v);
void get(Reader& from, std::optional<bool>& v);
void get(Reader& from, MonoTime& v);
void get(Reader& from, FoundDevice& v);

template <class T>
void put(Writer& to, const std::vector<T>& all) {
  to.u32(static_cast<std::uint32_t>(all.size()));
  for (const T& v : all) put(to, v);
}
template <class T>
void get(Reader& from, std::vector<T>& all) {
  for (std::uint32_t left = from.u32(); left > 0 && from.ok(); --left)
    get(from, all.emplace_back());
}
template <class T>
Bytes bodyOf(const T& v) {
  Writer to;
  put(to, v);
  return to.take();
}

}  // namespace patina::devices::host
