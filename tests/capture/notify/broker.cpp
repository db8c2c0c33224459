// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/notify/broker.h"

#include <fcntl.h>
#include <mosquitto.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <stdexcept>

#include "tests/capture/notify/receiver.h"

namespace patina::testing {
namespace {

constexpr const char* kProgram = "/usr/sbin/mosquitto";

}  // namespace

bool Broker::installed() { return access(kProgram, X_OK) == 0; }

Broker::Broker(std::string config) : port_(freePort()) {
  writeFile(folder_ / "mosquitto.conf", "listener " + std::to_string(port_) +
                                            " 127.0.0.1\npersistence false\n" +
                                            (geteuid() == 0 ? "user root\n" : "") + config + "\n");
  start();
}

Broker::~Broker() { stop(); }

// It says on stderr when it listens.
void Broker::start() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDERR_FILENO);
  std::string program = kProgram, option = "-c", file = (folder_ / "mosquitto.conf").string(),
              verbose = "-v";
  char* const arguments[] = {program.data(), option.data(), file.data(), verbose.data(), nullptr};
  if (posix_spawn(&pid_, kProgram, &files, nullptr, arguments, environ) != 0) pid_ = 0;
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  std::string said;
  char piece[512];
  while (said.find(" running") == std::string::npos) {
    const ssize_t got = read(ends[0], piece, sizeof piece);
    if (got <= 0) throw std::runtime_error("mosquitto does not start: " + said);
    said.append(piece, static_cast<std::size_t>(got));
  }
  // What it says later goes nowhere: it ignores SIGPIPE.
  close(ends[0]);
}

void Broker::stop() {
  if (pid_ == 0) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
  pid_ = 0;
}

capture::MqttSettings Broker::settings() const {
  capture::MqttSettings settings;
  settings.host = "127.0.0.1";
  settings.port = port_;
  return settings;
}

Listener::Listener(const capture::MqttSettings& broker, const std::string& filter)
    : filter_(filter) {
  mosquitto_lib_init();
  client_ = mosquitto_new(nullptr, true, this);
  mosquitto_connect_callback_set(client_, onConnect);
  mosquitto_subscribe_callback_set(client_, onSubscribe);
  mosquitto_message_callback_set(client_, onMessage);
  if (mosquitto_connect(client_, broker.host.c_str(), broker.port, 30) != MOSQ_ERR_SUCCESS ||
      mosquitto_loop_start(client_) != MOSQ_ERR_SUCCESS)
    throw std::runtime_error("cannot listen to the broker");
  std::unique_lock lock(mutex_);
  came_.wait(lock, [&] { return subscribed_; });
}

Listener::~Listener() {
  mosquitto_disconnect(client_);
  mosquitto_loop_stop(client_, false);
  mosquitto_destroy(client_);
}

void Listener::onConnect(mosquitto* client, void* user, int) {
  mosquitto_subscribe(client, nullptr, static_cast<Listener*>(user)->filter_.c_str(), 1);
}

void Listener::onSubscribe(mosquitto*, void* user, int, int, const int*) {
  auto& self = *static_cast<Listener*>(user);
  const std::lock_guard lock(self.mutex_);
  self.subscribed_ = true;
  self.came_.notify_all();
}

void Listener::onMessage(mosquitto*, void* user, const mosquitto_message* message) {
  auto& self = *static_cast<Listener*>(user);
  const std::lock_guard lock(self.mutex_);
  self.newest_[message->topic] = std::string(static_cast<const char*>(message->payload),
                                             static_cast<std::size_t>(message->payloadlen));
  self.retained_ += message->retain ? 1 : 0;
  self.came_.notify_all();
}

void Listener::waitFor(const std::string& topic, const std::string& payload) {
  std::unique_lock lock(mutex_);
  came_.wait(lock, [&] { return newest_.count(topic) != 0 && newest_[topic] == payload; });
}

std::string Listener::waitForAny(const std::string& topic) {
  std::unique_lock lock(mutex_);
  came_.wait(lock, [&] { return newest_.count(topic) != 0; });
  return newest_[topic];
}

std::map<std::string, std::string> Listener::newest() const {
  const std::lock_guard lock(mutex_);
  return newest_;
}

int Listener::retained() const {
  const std::lock_guard lock(mutex_);
  return retained_;
}

}  // namespace patina::testing
