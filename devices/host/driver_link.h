// SPDX-License-Identifier: GPL-3.0-or-later
// The parent's side: a process that holds devices, here or on another machine, and calls to it.
#pragma once

#include <atomic>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "devices/clock.h"
#include "devices/host/channel.h"
#include "devices/host/child_process.h"
#include "devices/host/messages.h"

namespace patina::devices::host {

struct RemoteHost {
  std::string address;  // "pi.local:8461"
  std::filesystem::path key;
};

struct LinkOptions {
  std::string name;  // for messages: "driver of 'cam0'"
  Hello hello;
  std::vector<std::string> command{"/proc/self/exe", "device-host"};
  std::optional<RemoteHost> remote;                    // instead of `command`
  Nanoseconds start_limit = std::chrono::seconds(10);  // until its first answer
  // Four beats: a process that is stopped, or a machine that is gone, is not waited for.
  Nanoseconds silence_max = std::chrono::seconds(2);
  // Another machine is asked so often whether it is there, and so told that this one is.
  Nanoseconds ask_every = std::chrono::seconds(1);
};

// One call at a time; any thread. Real time throughout, also for a rig whose time is told.
// What a backend sees attached, looked for in a process that is killed after `limit`: a sick device
// can hang its library.
Result<std::vector<FoundDevice>> findInProcess(const std::vector<std::string>& command,
                                               const std::string& backend, Nanoseconds limit);

class DriverLink {
 public:
  DriverLink(LinkOptions options, Clock& clock);
  ~DriverLink();

  // Starts the process, or calls the other machine, when there is none. After three starts with no
  // rested() between, starts have a distance: 1 s, doubled up to a minute; too early is kLost.
  Result<void> start();
  void stop();                    // closes the channel, waits a little, then kills
  void rested() { starts_ = 0; }  // a device of it was opened
  bool running() const { return running_; }

  struct Reply {
    Bytes body;
    std::optional<Bytes> part;  // what came before the last answer
    std::optional<Error> cut;   // the last answer never came: why; `part` is all there is
  };
  // kTimeout: not answered within `limit`, and killed for it. kLost: it is not running or died; its
  // error otherwise. A call that had a part before it was cut off is a Reply with `cut`.
  Result<Reply> call(std::uint16_t device, Op op, const Bytes& body, Nanoseconds limit);

  std::uint64_t memoryBytes() const { return memory_bytes_; }
  int startCount() const { return start_count_; }
  // Of another machine: their time and this one's.
  UtcTime ours(UtcTime theirs) const { return theirs + utc_offset_; }
  MonoTime ours(MonoTime theirs) const { return theirs + mono_offset_; }

 private:
  Result<void> connect();
  Result<void> greet(MonoTime deadline);
  Result<Reply> exchange(const Call& call, MonoTime deadline);
  void drop(bool by_force);
  void keepAsking(const std::stop_token& stop);
  Error named(Error error) const;

  LinkOptions options_;
  Clock& clock_;  // of the rig: what the process is told
  RealClock real_;
  std::mutex mutex_;                        // guards what follows
  std::shared_ptr<const DriverHome> home_;  // of all its processes
  std::unique_ptr<ChildProcess> process_;
  std::unique_ptr<Channel> channel_;
  std::atomic<bool> running_{false};
  std::atomic<std::uint64_t> memory_bytes_{0};
  std::uint32_t calls_ = 0;
  std::atomic<int> starts_{0}, start_count_{0};
  MonoTime last_start_{};
  Nanoseconds utc_offset_{}, mono_offset_{};
  std::string ended_by_;  // why it is not running, where that is no news to a caller
  std::jthread asking_;   // last: ends before what it uses
};

}  // namespace patina::devices::host
