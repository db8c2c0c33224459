// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/child.h"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "tests/support/places.h"

namespace patina::testing {

namespace {

std::vector<char*> pointers(std::vector<std::string>& words) {
  std::vector<char*> out;
  for (std::string& word : words) out.push_back(word.data());
  out.push_back(nullptr);
  return out;
}

// Ours, with `added` in place of variables of the same name.
std::vector<std::string> environmentWith(const std::vector<std::string>& added) {
  std::vector<std::string> all = added;
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const std::string ours = *variable;
    const std::string name = ours.substr(0, ours.find('=') + 1);
    bool replaced = false;
    for (const std::string& a : added) replaced = replaced || a.starts_with(name);
    if (!replaced) all.push_back(ours);
  }
  return all;
}

}  // namespace

Child::Child(std::vector<std::string> command, const std::vector<std::string>& environment) {
  const std::string out = (folder_ / "out").string(), err = (folder_ / "err").string();
  std::vector<std::string> all = environmentWith(environment);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), flags, 0600);
  const int error = posix_spawn(&pid_, command.at(0).c_str(), &actions, nullptr,
                                pointers(command).data(), pointers(all).data());
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) {
    pid_ = 0;
    throw std::system_error(error, std::generic_category(), command[0]);
  }
}

Child::~Child() {
  if (pid_ == 0) return;
  ::kill(pid_, SIGKILL);
  ::waitpid(pid_, nullptr, 0);
}

void Child::signal(int number) const {
  if (pid_ != 0) ::kill(pid_, number);
}

Finished Child::wait() {
  int status = 0;
  while (::waitpid(pid_, &status, 0) < 0)
    if (errno != EINTR) throw std::system_error(errno, std::generic_category(), "waitpid");
  pid_ = 0;
  Finished done;
  if (WIFEXITED(status)) done.exit = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) done.signal = WTERMSIG(status);
  done.out = readFile(folder_ / "out");
  done.err = readFile(folder_ / "err");
  return done;
}

Finished run(std::vector<std::string> command, const std::vector<std::string>& environment) {
  return Child(std::move(command), environment).wait();
}

Finished runPatina(std::vector<std::string> arguments,
                   const std::vector<std::string>& environment) {
  arguments.insert(arguments.begin(), program().string());
  return run(std::move(arguments), environment);
}

}  // namespace patina::testing
