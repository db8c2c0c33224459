// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/ptpip_server.h"

#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <list>
#include <thread>
#include <utility>

#include "devices/twin/dslr/due_signal.h"
#include "devices/twin/dslr/wire_connection.h"

namespace patina::devices::twin::dslr {
namespace {

// Clients that have not said yet what they want. One more drives out the one that has waited most.
constexpr std::size_t kStrangersMax = 8;

bool endedWith(short events) { return (events & (POLLRDHUP | POLLHUP | POLLERR | POLLNVAL)) != 0; }

}  // namespace

class PtpIpServer::Impl {
 public:
  Impl(Dslr& camera, std::string address, int port)
      : camera_(camera),
        address_(std::move(address)),
        listener_(listenAt(address_, port)),
        port_(portOf(listener_)),
        due_(camera.clock()) {
    camera_.onChange([this] { due_.wake(); });
    thread_ = std::thread([this] { run(); });
  }
  ~Impl() {
    stop_ = true;
    due_.wake();
    thread_.join();
    camera_.onChange({});
  }

  int port() const { return port_; }
  const std::string& address() const { return address_; }

 private:
  void run();
  void wait();
  void welcome();
  void hear(WireConnection& stranger);
  void serve();
  void perform(const PtpCommand& command);
  void say();
  void dropClient();
  void obeyPower();
  std::optional<MonoTime> nextDue() const;

  Dslr& camera_;
  std::string address_;
  Socket listener_;
  int port_;
  DueSignal due_;
  std::atomic<bool> stop_{false};

  // Of the serving thread alone.
  std::list<WireConnection> strangers_;
  std::optional<WireConnection> commands_, events_;
  CommandReader reader_;
  std::uint32_t connection_ = 0;  // its number
  std::thread thread_;
};

std::optional<MonoTime> PtpIpServer::Impl::nextDue() const {
  const auto stalled = commands_ ? commands_->stalledUntil() : std::nullopt;
  if (!stalled) return camera_.nextDue();
  return *stalled == MonoTime::max() ? std::nullopt : stalled;
}

void PtpIpServer::Impl::run() {
  while (!stop_) {
    obeyPower();
    say();
    due_.arm(nextDue());
    wait();
  }
}

// Without power nobody is heard: who was there is cut off, who comes is turned away.
void PtpIpServer::Impl::obeyPower() {
  if (camera_.isOn()) return;
  if (commands_) commands_->reset();
  if (events_) events_->reset();
  for (WireConnection& stranger : strangers_) stranger.reset();
  strangers_.clear();
  dropClient();
}

void PtpIpServer::Impl::wait() {
  std::vector<pollfd> fds = {{due_.fd(), POLLIN, 0}, {listener_.fd(), POLLIN, 0}};
  const auto add = [&](const WireConnection& one) {
    short events = POLLRDHUP;
    if (one.isIdle()) events |= POLLIN;
    if (one.wantsToSend()) events |= POLLOUT;
    fds.push_back({one.fd(), events, 0});
  };
  if (commands_) add(*commands_);
  if (events_) add(*events_);
  for (const WireConnection& stranger : strangers_) add(stranger);
  while (poll(fds.data(), fds.size(), -1) < 0) continue;  // EINTR

  if (fds[0].revents != 0) due_.clear();
  std::size_t i = 2;
  // A client that ends is read to its end where it can be, and else is gone.
  const auto take = [&](WireConnection& one) {
    const short events = fds[i++].revents;
    if ((events & POLLIN) != 0) {
      one.receive();
    } else if (endedWith(events)) {
      one.close();
    }
  };
  if (commands_) take(*commands_);
  if (events_) take(*events_);
  for (WireConnection& stranger : strangers_) take(stranger);
  serve();
  for (WireConnection& stranger : strangers_) hear(stranger);
  strangers_.remove_if([](const WireConnection& one) { return !one.isOpen(); });
  if (fds[1].revents != 0) welcome();
}

void PtpIpServer::Impl::welcome() {
  Socket client(accept4(listener_.fd(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (client.fd() < 0) return;
  if (strangers_.size() >= kStrangersMax) strangers_.pop_front();
  strangers_.emplace_back(std::move(client));
}

void PtpIpServer::Impl::hear(WireConnection& stranger) {
  stranger.send(camera_.clock().mono());
  if (!stranger.isOpen()) return;
  const auto packet = stranger.next();
  if (!packet) return;
  const auto refuse = [&](InitFailure why) {
    stranger.queue(initFail(why));
    stranger.send(camera_.clock().mono());
    stranger.close();
  };
  if (packet->type == PacketType::kInitCommandRequest) {
    if (commands_) return refuse(InitFailure::kBusy);
    stranger.queue(
        initCommandAck(++connection_, camera_.options().model, camera_.options().serial));
    commands_ = std::exchange(stranger, WireConnection(Socket()));
    reader_ = {};
  } else if (packet->type == PacketType::kInitEventRequest) {
    if (!commands_ || events_ || connectionOf(*packet) != connection_)
      return refuse(InitFailure::kRejected);
    stranger.queue(initEventAck());
    events_ = std::exchange(stranger, WireConnection(Socket()));
    events_->send(camera_.clock().mono());
  } else {
    return refuse(InitFailure::kRejected);
  }
  stranger.close();
  serve();
}

void PtpIpServer::Impl::serve() {
  if (!commands_) return;
  commands_->goOn(camera_.clock().mono());
  commands_->send(camera_.clock().mono());
  while (commands_->isIdle()) {
    const auto packet = commands_->next();
    if (!packet) break;
    if (packet->type == PacketType::kProbeRequest) {
      commands_->queue(probeResponse());
    } else if (packet->type != PacketType::kProbeResponse) {
      if (const auto command = reader_.take(*packet)) perform(*command);
      if (reader_.bad()) commands_->close();
    }
    commands_->send(camera_.clock().mono());
  }
  if (!commands_->isOpen() || (events_ && !events_->isOpen())) dropClient();
}

void PtpIpServer::Impl::perform(const PtpCommand& command) {
  const PtpReply reply = camera_.perform(command);
  const Bytes packets = replyPackets(reply, command.transaction);
  if (reply.trouble)
    commands_->queue(packets, *reply.trouble);
  else
    commands_->queue(packets);
}

void PtpIpServer::Impl::say() {
  if (commands_ && commands_->stalledUntil()) return;  // a camera that hangs says nothing at all
  const auto said = camera_.takeEvents();
  if (!events_) return;
  for (const PtpEvent& event : said) events_->queue(eventPacket(event));
  events_->send(camera_.clock().mono());
  // Clients say nothing here but probes, which need no answer of a camera that answers commands.
  while (events_->isOpen() && events_->next()) continue;
  if (!events_->isOpen()) dropClient();
}

void PtpIpServer::Impl::dropClient() {
  if (!commands_ && !events_) return;
  commands_.reset();
  events_.reset();
  camera_.hangUp();
}

PtpIpServer::PtpIpServer(Dslr& camera, const std::string& address, int port)
    : impl_(std::make_unique<Impl>(camera, address, port)) {}
PtpIpServer::~PtpIpServer() = default;

int PtpIpServer::port() const { return impl_->port(); }

std::string PtpIpServer::gphotoPort() const {
  const std::string port = std::to_string(impl_->port());
  return "ptpip:" + impl_->address() + ":" + port + ":" + port;
}

}  // namespace patina::devices::twin::dslr
