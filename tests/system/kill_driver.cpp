// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/kill_driver.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>

#include "devices/clock.h"
#include "processing/image/random.h"
#include "tests/support/child.h"
#include "tests/system/victim.h"

namespace patina::testing {
namespace {

// The lines of a pipe, as they come.
class Lines {
 public:
  explicit Lines(int end) : end_(end) {}
  ~Lines() { ::close(end_); }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  // The next whole line; false at the end.
  bool next(std::string* line) {
    for (;;) {
      const auto newline = text_.find('\n');
      if (newline != std::string::npos) {
        *line = text_.substr(0, newline);
        text_.erase(0, newline + 1);
        return true;
      }
      std::array<char, 4096> block;
      const ssize_t got = ::read(end_, block.data(), block.size());
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) return false;
      text_.append(block.data(), static_cast<std::size_t>(got));
    }
  }

 private:
  int end_;
  std::string text_;
};

}  // namespace

struct KillDriver::Death {
  std::int64_t after_acks = 0;  // by our hand, so long after so many; 0: after the start
  Nanoseconds delay{};
};

KillDriver::KillDriver(VictimProgram program, std::uint64_t seed)
    : program_(std::move(program)), seed_(seed) {}

KillDriver::Death KillDriver::chooseDeath(int round, std::vector<std::string>* command) {
  const std::uint64_t own = hashSeed(seed_, round);
  Death death;
  if (!program_.point_command.empty() && round % 2 == 0) {
    *command = program_.point_command;
    const auto point = static_cast<db::CommitPoint>(round / 2 % db::kCommitPointCount);
    command->push_back("--die-at");
    command->push_back(std::string(db::name(point)) + ":" +
                       std::to_string(1 + uniformBelow(own, 12)));
    death.after_acks = 1000;
    ++at_points_;
    return death;
  }
  // Every third of these while it starts, the others within a few commits of a random frame.
  const bool early = round % 3 == 0;
  death.after_acks = early ? 0 : 1 + static_cast<std::int64_t>(uniformBelow(own, 20));
  death.delay = std::chrono::microseconds(uniformBelow(hashSeed(own, 1), early ? 40'000 : 4'000));
  return death;
}

std::vector<std::string> KillDriver::kill(int round) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) return {"no pipe"};
  const int acks = ::dup(ends[1]);  // the child's, without close-on-exec
  ::close(ends[1]);
  std::vector<std::string> command = program_.command;
  const Death death = chooseDeath(round, &command);
  fillIn(command, acks);

  devices::RealClock clock;
  const MonoTime began = clock.mono();
  Child child(command);
  ::close(acks);
  Lines lines(ends[0]);
  const auto end_it = [&] {
    clock.sleepUntil(clock.mono() + death.delay, {});
    child.signal(SIGKILL);
  };
  if (death.after_acks == 0) end_it();
  std::int64_t count = 0;
  for (std::string line; lines.next(&line);) {
    judge_.note(parseAck(line));
    if (++count == 1) slowest_start_ = std::max(slowest_start_, clock.mono() - began);
    if (count == death.after_acks) end_it();
  }
  const Finished finished = child.wait();
  if (finished.signal != SIGKILL)
    return {"the victim ended by itself, exit " + std::to_string(finished.exit) + ": " +
            finished.err};
  return judge(round % 4 >= 2);
}

std::vector<std::string> KillDriver::judge(bool recovered) const {
  const auto archive = folder_ / "archive";
  if (!std::filesystem::exists(archive / "catalog.sqlite"))
    return judge_.count() == 0 ? std::vector<std::string>{}
                               : std::vector<std::string>{"the catalogue is gone"};
  try {
    if (recovered) {
      db::ArchiveOptions options;
      options.folder = archive;
      options.owner = "kill driver";
      const db::Archive owner(options);
      return judge_.judgeRecovered(archive);
    }
    // Before the first acknowledgement there may be no tables yet.
    if (judge_.count() > 0) return judge_.judgeCatalogue(archive);
  } catch (const Failure& e) {
    return {e.what()};
  }
  return {};
}

void KillDriver::fillIn(std::vector<std::string>& command, int acks) const {
  for (std::string& word : command) {
    if (word == "{archive}") word = archive().string();
    if (word == "{acks}") word = std::to_string(acks);
  }
}

}  // namespace patina::testing
