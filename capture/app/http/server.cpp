// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/server.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <future>
#include <stop_token>
#include <thread>

#include "capture/app/http/answer.h"
#include "capture/app/http/connections.h"
#include "capture/app/http/credentials.h"
#include "capture/app/http/fields.h"
#include "capture/app/http/gate.h"
#include "capture/app/http/listener.h"
#include "capture/app/http/own_routes.h"
#include "capture/app/http/private_file.h"
#include "capture/app/http/sockets.h"

namespace patina::http {
namespace {

constexpr int kNiceness = 10;  // below capture, which runs at 0 or better
constexpr std::size_t kEpochDigits = 8;

// Both for this thread and those it makes. Signals are for the thread that waits for them.
void leaveSignals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
}
void stepBack() { setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNiceness); }

// Nothing is read, bound or written when the options do not go together.
void check(const ServerOptions& options, const Credentials& credentials) {
  if (options.tls_certificate.empty() != options.tls_key.empty())
    throw HttpError(Exit::kConfig, "TLS needs a certificate and a key");
  if (!options.listen.empty())
    checkExposure(options.listen, credentials.hasNamedToken(), !options.tls_key.empty(),
                  options.behind_proxy);
}

// A listener may end only when no connection rests: neither on a handler nor on an event.
struct Quiet {
  WorkerPool& workers;
  EventBroker& events;
  ~Quiet() {
    workers.stop();
    events.stop();
  }
};

}  // namespace

class Server::Impl {
 public:
  Impl(const ServerOptions& options, std::vector<Route> routes, devices::Clock& clock,
       Metrics& metrics)
      : options_(options),
        clock_(clock),
        metrics_(metrics),
        credentials_(clock, options.named_tokens) {
    check(options_, credentials_);
    bindSockets();
    std::promise<void> started;
    auto ready = started.get_future();
    thread_ = std::jthread(
        [this, &routes, &started](const std::stop_token& stop) { run(stop, routes, started); });
    ready.get();
  }

  ~Impl() {
    thread_ = {};  // asks to stop and waits
    if (!options_.socket.empty()) unlink(options_.socket.c_str());
    if (!options_.token_file.empty()) unlink(options_.token_file.c_str());
  }

  void publish(const std::string& event, const std::string& data) { events_->publish(event, data); }
  int port() const { return port_; }
  std::string newLink(Role role) { return linkOf(credentials_.newTicket(role)); }

 private:
  bool overTls() const { return !options_.tls_key.empty() || options_.behind_proxy; }

  void bindSockets() {
    if (!options_.tls_key.empty()) {
      certificate_ = readCertificate(options_.tls_certificate);
      key_ = readKey(options_.tls_key);
    }
    if (!options_.listen.empty()) {
      tcp_ = listenOnTcp(options_.listen, options_.port);
      port_ = portOf(tcp_);
    }
    if (!options_.socket.empty()) unix_ = listenOnUnix(options_.socket, options_.socket_group);
    if (!options_.token_file.empty())
      writePrivateFile(options_.token_file, credentials_.addProcessToken(Role::kAdmin) + "\n");
  }

  std::string linkOf(const std::string& ticket) const {
    const std::string port = ":" + std::to_string(port_);
    if (options_.host_names.empty())
      return (options_.tls_key.empty() ? "http" : "https") + ("://127.0.0.1" + port) +
             "/#t=" + ticket;
    return (overTls() ? "https://" : "http://") + options_.host_names.front() +
           (options_.behind_proxy ? "" : port) + "/#t=" + ticket;
  }

  RouteTable tableOf(std::vector<Route> routes) {
    for (Route& route : ownRoutes({.credentials = credentials_,
                        .cookie = cookieName(),
                        .cookie_over_tls_only = overTls(),
                        .link = [this](const std::string& t) { return linkOf(t); },
                        .metrics_text = [this] { return metricsText(); }}))
      routes.push_back(std::move(route));
    return RouteTable(std::move(routes));
  }

  // Cookies know no ports: two daemons on one host must not take each other's.
  std::string cookieName() const { return "patina_session_" + std::to_string(port_); }

  std::string metricsText() {
    const EventBroker::Counts counts = events_->counts();
    raise(metrics_.counter("patina_http_events_total"), counts.published);
    raise(metrics_.counter("patina_dropped_total", {"event"}), counts.dropped_events);
    raise(metrics_.counter("patina_dropped_total", {"event_stream"}), counts.dropped_streams);
    metrics_.gauge("patina_http_streams").set(static_cast<double>(counts.streams));
    metrics_.gauge("patina_http_connections").set(static_cast<double>(connections_.count()));
    metrics_.gauge("patina_up").set(1);
    collectProcess(metrics_);
    return metrics_.text();
  }

  static void raise(Counter& counter, std::uint64_t to) {
    counter.add(static_cast<double>(to) - counter.value());
  }

  // The thread that owns all others, keeps the deadlines and ends it all in order.
  void run(const std::stop_token& stop, std::vector<Route>& routes, std::promise<void>& started) {
    leaveSignals();
    bool is_started = false;
    try {
      // Handlers hold locks that capture needs, those of SQLite above all, and are admitted by
      // token: they keep the daemon's priority, or a busy machine would let capture wait for a
      // thread that it does not let run. What strangers can make work for steps back.
      WorkerPool workers(options_.limits.workers);
      stepBack();
      const RouteTable table = tableOf(std::move(routes));
      const Gate gate({.scheme = overTls() ? "https" : "http",
                       .hosts = allowedHosts(port_, options_.host_names, overTls()),
                       .cookie = cookieName(),
                       .header_bytes_max = options_.limits.header_bytes,
                       .body_bytes_max = options_.limits.body_bytes},
                      table, credentials_);
      ByteBudget budget(options_.limits.bytes_in_flight);
      const AnswerMaker answers(options_.archive, budget);
      events_.emplace(options_.limits.events, newToken().substr(0, kEpochDigits));
      const Desk desk{gate,   answers,  connections_, *events_,       workers,
                      budget, metrics_, clock_,       options_.limits};
      std::unique_ptr<Listener> tcp, local;
      const Quiet quiet{workers, *events_};
      if (tcp_.fd() >= 0) tcp = std::make_unique<Listener>(std::move(tcp_), tcpOptions(), desk);
      if (unix_.fd() >= 0)
        local = std::make_unique<Listener>(std::move(unix_), unixOptions(), desk);
      is_started = true;
      const MonoTime begun = clock_.mono();
      started.set_value();
      keepHouse(stop, begun);
    } catch (...) {
      // Later, only a process without a free descriptor comes here. It serves no longer; capture
      // goes on.
      if (!is_started) started.set_exception(std::current_exception());
    }
  }

  ListenerOptions tcpOptions() const {
    const ServerLimits& limits = options_.limits;
    return {.connections = limits.tcp_connections,
            .connections_a_peer = options_.behind_proxy ? 0 : limits.connections_a_peer,
            .local = false,
            .group_role = Role::kPublic,
            .tls_certificate = certificate_,
            .tls_key = key_};
  }

  ListenerOptions unixOptions() const {
    return {.connections = options_.limits.unix_connections,
            .connections_a_peer = 0,
            .local = true,
            .group_role = options_.group_role,
            .tls_certificate = {},
            .tls_key = {}};
  }

  void keepHouse(const std::stop_token& stop, MonoTime begun) {
    constexpr std::chrono::seconds kRound{1};
    MonoTime beat_due = begun + options_.limits.heartbeat;
    // A round that was late is followed by another at once, never by a run of those it missed.
    for (MonoTime due = begun + kRound; clock_.sleepUntil(due, stop) == devices::Wake::kDue;
         due = std::max(due + kRound, clock_.mono())) {
      const Connections::Shut shut = connections_.shutLate(clock_.mono());
      late_.add(static_cast<double>(shut.late));
      if (shut.streams > 0) events_->nudge();
      if (clock_.mono() < beat_due) continue;
      events_->beat();
      beat_due = clock_.mono() + options_.limits.heartbeat;
    }
  }

  const ServerOptions options_;
  devices::Clock& clock_;
  Metrics& metrics_;
  Counter& late_ = metrics_.counter("patina_http_late_total");  // from the first scrape on
  Credentials credentials_;
  devices::Descriptor tcp_, unix_;
  int port_ = 0;
  std::string certificate_, key_;
  Connections connections_;
  std::optional<EventBroker> events_;
  std::jthread thread_;
};

Server::Server(const ServerOptions& options, std::vector<Route> routes, devices::Clock& clock,
               Metrics& metrics)
    : impl_(std::make_unique<Impl>(options, std::move(routes), clock, metrics)) {}

Server::~Server() = default;

void Server::publish(const std::string& event, const std::string& json_data) {
  impl_->publish(event, json_data);
}

int Server::port() const { return impl_->port(); }

std::string Server::newLink(Role role) { return impl_->newLink(role); }

}  // namespace patina::http
