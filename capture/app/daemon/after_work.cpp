// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/after_work.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace patina::daemon {

AfterWork::AfterWork(std::vector<std::string> command,
                     std::function<void(const std::string&, const std::string&)> done)
    : command_(std::move(command)), done_(std::move(done)), thread_([this] { run(); }) {}

AfterWork::~AfterWork() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    if (child_ > 0) ::kill(child_, SIGTERM);
  }
  changed_.notify_all();
  thread_.join();
}

void AfterWork::add(const std::string& run_id) {
  {
    const std::lock_guard lock(mutex_);
    if (std::find(queue_.begin(), queue_.end(), run_id) != queue_.end()) return;
    queue_.push_back(run_id);
  }
  changed_.notify_all();
}

std::size_t AfterWork::waiting() const {
  const std::lock_guard lock(mutex_);
  return queue_.size();
}

void AfterWork::run() {
  for (;;) {
    std::string run_id;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ending_ || !queue_.empty(); });
      if (ending_) return;
      run_id = queue_.front();
    }
    const std::string trouble = make(run_id);
    {
      const std::lock_guard lock(mutex_);
      if (ending_) return;
      queue_.pop_front();
    }
    done_(run_id, trouble);
  }
}

// Its standard input is empty, its output ours.
std::string AfterWork::make(const std::string& run_id) {
  std::vector<std::string> words = command_;
  words.push_back(run_id);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  int error = 0;
  {
    // Under the lock, so that an end that comes now finds the child.
    const std::lock_guard lock(mutex_);
    if (!ending_)
      error = posix_spawn(&child, words[0].c_str(), &actions, nullptr, arguments.data(), environ);
    child_ = error == 0 ? child : 0;
  }
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return words[0] + ": " + std::strerror(error);
  if (child == 0) return "the daemon is ending";
  // Waited for without being reaped, so that the number stays its own while it may be signalled.
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(child), &info, WEXITED | WNOWAIT) < 0 && errno == EINTR)
    continue;
  const std::lock_guard lock(mutex_);
  child_ = 0;
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  if (WIFSIGNALED(status)) return "ended by signal " + std::to_string(WTERMSIG(status));
  return WEXITSTATUS(status) == 0 ? "" : "exit " + std::to_string(WEXITSTATUS(status));
}

}  // namespace patina::daemon
