// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/listener.h"

#include <microhttpd.h>
#include <sys/socket.h>

#include <exception>
#include <optional>
#include <utility>
#include <vector>

#include "capture/app/http/sockets.h"

namespace patina::http {
namespace {

// libmicrohttpd keeps a request's header and its answer's in one block of this size. One larger
// than 32 KiB it would map and unmap with each connection, under the lock of the whole address
// space.
constexpr std::size_t kConnectionBytes = 32 << 10, kStackBytes = 256 << 10;
constexpr std::size_t kStreamBlockBytes = 4 << 10;
// Seconds without a byte; the deadlines of connections.h come first.
constexpr unsigned kSilenceBackstopS = 120;

// A request from its first line to the end of its answer.
struct Exchange {
  std::string target;
  Connection* connection = nullptr;
  bool admitted = false, submitted = false;
  Admission admission;
  ByteBudget::Share body_share;
  std::optional<Response> response;  // written by a worker before it resumes the connection
};

struct OpenStream {
  EventBroker& events;
  std::shared_ptr<EventBroker::Stream> stream;
  MHD_Connection* connection;
};

Connection* connectionOf(MHD_Connection* connection) {
  return static_cast<Connection*>(
      MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context);
}

RequestHead headOf(MHD_Connection* from, const char* method, const Exchange& exchange) {
  RequestHead head;
  head.method = method;
  head.target = exchange.target;
  head.header_bytes =
      MHD_get_connection_info(from, MHD_CONNECTION_INFO_REQUEST_HEADER_SIZE)->header_size;
  head.peer = exchange.connection->peer;
  head.local = exchange.connection->local;
  head.local_role = exchange.connection->local_role;
  MHD_get_connection_values_n(
      from, MHD_HEADER_KIND,
      [](void* fields, MHD_ValueKind, const char* key, std::size_t key_bytes, const char* value,
         std::size_t value_bytes) {
        static_cast<decltype(head.fields)*>(fields)->emplace_back(
            std::string(key, key_bytes),
            value == nullptr ? std::string() : std::string(value, value_bytes));
        return MHD_YES;
      },
      &head.fields);
  return head;
}

Response runHandler(const Admission& admission) {
  try {
    return admission.route->handler(admission.request);
  } catch (const Failure& failure) {
    return errorResponse(failure);
  } catch (const std::bad_alloc&) {
    return errorResponse(503, Exit::kTemporary, "out of memory: try again");
  } catch (const std::exception&) {
    return errorResponse(500, Exit::kBug, "this is a bug of ours, please report it");
  }
}

ssize_t readStream(void* cls, std::uint64_t, char* bytes, std::size_t most) {
  auto& open = *static_cast<OpenStream*>(cls);
  const long n = open.events.read(*open.stream, {bytes, most},
                                  [&open] { MHD_suspend_connection(open.connection); });
  return n < 0 ? MHD_CONTENT_READER_END_OF_STREAM : n;
}

void closeStream(void* cls) {
  const std::unique_ptr<OpenStream> open(static_cast<OpenStream*>(cls));
  open->events.close(open->stream);
}

}  // namespace

class Listener::Impl {
 public:
  Impl(devices::Descriptor socket, ListenerOptions options, const Desk& desk)
      : options_(std::move(options)), desk_(desk) {
    std::vector<MHD_OptionItem> items = {
        {MHD_OPTION_LISTEN_SOCKET, socket.fd(), nullptr},
        {MHD_OPTION_CONNECTION_LIMIT, static_cast<std::intptr_t>(options_.connections), nullptr},
        {MHD_OPTION_PER_IP_CONNECTION_LIMIT,
         static_cast<std::intptr_t>(options_.connections_a_peer), nullptr},
        {MHD_OPTION_CONNECTION_TIMEOUT, kSilenceBackstopS, nullptr},
        {MHD_OPTION_CONNECTION_MEMORY_LIMIT, kConnectionBytes, nullptr},
        {MHD_OPTION_THREAD_STACK_SIZE, kStackBytes, nullptr},
        {MHD_OPTION_STRICT_FOR_CLIENT, 1, nullptr}};
    unsigned flags = MHD_USE_EPOLL_INTERNAL_THREAD | MHD_USE_SUSPEND_RESUME;
    if (!options_.tls_certificate.empty()) {
      flags |= MHD_USE_TLS;
      items.push_back({MHD_OPTION_HTTPS_MEM_CERT, 0, options_.tls_certificate.data()});
      items.push_back({MHD_OPTION_HTTPS_MEM_KEY, 0, options_.tls_key.data()});
    }
    items.push_back({MHD_OPTION_END, 0, nullptr});
    daemon_ = MHD_start_daemon(flags, 0, nullptr, nullptr, &Impl::onRequest, this,
                               MHD_OPTION_URI_LOG_CALLBACK, &Impl::onTarget, this,
                               MHD_OPTION_NOTIFY_COMPLETED, &Impl::onCompleted, this,
                               MHD_OPTION_NOTIFY_CONNECTION, &Impl::onConnection, this,
                               MHD_OPTION_ARRAY, items.data(), MHD_OPTION_END);
    if (daemon_ == nullptr)
      throw HttpError(Exit::kUnavailable,
                      options_.tls_certificate.empty()
                          ? "the HTTP server does not start: too many open files?"
                          : "the HTTP server does not start: do certificate and key belong "
                            "together, in PEM?");
    socket.release();  // libmicrohttpd closes it
  }

  ~Impl() { MHD_stop_daemon(daemon_); }

 private:
  static void onConnection(void* cls, MHD_Connection* connection, void** context,
                           MHD_ConnectionNotificationCode what) {
    auto& self = *static_cast<Impl*>(cls);
    if (what == MHD_CONNECTION_NOTIFY_STARTED) {
      *context = self.welcome(
          MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd);
    } else if (*context != nullptr) {
      self.desk_.connections.remove(static_cast<Connection*>(*context));
    }
  }

  // Null when memory is out: onTarget() then gives no exchange, and onRequest() hangs up.
  Connection* welcome(int fd) try {
    const Role role = options_.local ? roleOfPeer(fd, options_.group_role) : Role::kPublic;
    return desk_.connections.add({.fd = fd,
                                  .peer = peerName(fd),
                                  .local = options_.local,
                                  .stream = false,
                                  .local_role = role,
                                  .deadline = desk_.clock.mono() + desk_.limits.header});
  } catch (const std::bad_alloc&) {
    return nullptr;
  }

  static void* onTarget(void*, const char* target, MHD_Connection* connection) try {
    if (connectionOf(connection) == nullptr) return nullptr;
    auto exchange = std::make_unique<Exchange>();
    exchange->target = target;
    exchange->connection = connectionOf(connection);
    return exchange.release();
  } catch (const std::bad_alloc&) {
    return nullptr;
  }

  static void onCompleted(void* cls, MHD_Connection*, void** context, MHD_RequestTerminationCode) {
    auto& self = *static_cast<Impl*>(cls);
    const std::unique_ptr<Exchange> exchange(
        static_cast<Exchange*>(std::exchange(*context, nullptr)));
    if (exchange) self.setDeadline(*exchange, self.desk_.limits.idle);
  }

  static MHD_Result onRequest(void* cls, MHD_Connection* connection, const char*,
                              const char* method, const char*, const char* data,
                              std::size_t* data_bytes, void** context) {
    auto& self = *static_cast<Impl*>(cls);
    auto* const exchange = static_cast<Exchange*>(*context);
    if (exchange == nullptr) return MHD_NO;
    try {
      if (!exchange->admitted) return self.admit(connection, method, *exchange);
      if (*data_bytes > 0) return takeBody(*exchange, {data, std::exchange(*data_bytes, 0)});
      return self.serve(connection, *exchange);
    } catch (const std::exception&) {
      return MHD_NO;  // out of memory: this connection ends, the others go on
    }
  }

  MHD_Result admit(MHD_Connection* connection, const char* method, Exchange& exchange) {
    exchange.admitted = true;
    exchange.admission = desk_.gate.admit(headOf(connection, method, exchange));
    Admission& admission = exchange.admission;
    if (!admission.refusal && admission.body_bytes_expected > 0) {
      exchange.body_share = desk_.budget.take(admission.body_bytes_expected);
      if (!exchange.body_share)
        admission.refusal = errorResponse(503, Exit::kTemporary, "too much is sent at once: retry");
      else
        admission.request.body.reserve(admission.body_bytes_expected);  // growing would double it
    }
    if (admission.refusal)
      return send(connection, exchange, std::move(*std::exchange(admission.refusal, {})));
    setDeadline(exchange, desk_.limits.body);
    return MHD_YES;
  }

  // A body that goes on past its limit is not answered: reading the rest would be the harm.
  static MHD_Result takeBody(Exchange& exchange, std::string_view data) {
    std::string& body = exchange.admission.request.body;
    if (body.size() + data.size() > exchange.admission.body_bytes_max) return MHD_NO;
    body += data;
    return MHD_YES;
  }

  MHD_Result serve(MHD_Connection* connection, Exchange& exchange) {
    if (exchange.response)
      return send(connection, exchange, std::move(*std::exchange(exchange.response, {})));
    if (exchange.submitted) return MHD_YES;
    if (exchange.admission.route->operation_id == kStreamOperation)
      return openStream(connection, exchange);
    exchange.submitted = true;
    desk_.connections.setDeadline(exchange.connection, MonoTime::max());
    MHD_suspend_connection(connection);
    const bool taken = desk_.workers.submit([&exchange, connection] {
      exchange.response = runHandler(exchange.admission);
      MHD_resume_connection(connection);
    });
    if (!taken) {
      exchange.response = errorResponse(503, Exit::kTemporary, "the daemon is stopping");
      MHD_resume_connection(connection);
    }
    return MHD_YES;
  }

  MHD_Result send(MHD_Connection* connection, Exchange& exchange, Response response) {
    const Answer answer = desk_.answers.make(exchange.admission, std::move(response));
    if (answer.response == nullptr) return MHD_NO;
    const std::chrono::seconds reading(answer.bytes / desk_.limits.answer_bytes_per_s);
    setDeadline(exchange, desk_.limits.idle + reading);
    desk_.metrics.counter("patina_http_requests_total", {std::to_string(answer.status)}).add();
    const MHD_Result result =
        MHD_queue_response(connection, static_cast<unsigned>(answer.status), answer.response);
    MHD_destroy_response(answer.response);
    return result;
  }

  MHD_Result openStream(MHD_Connection* connection, Exchange& exchange) {
    const int fd = exchange.connection->fd;
    auto stream = desk_.events.open(
        exchange.connection->peer, exchange.admission.last_event_id,
        [connection] { MHD_resume_connection(connection); }, [fd] { shutdown(fd, SHUT_RDWR); });
    if (!stream) {
      Response busy =
          errorResponse(503, Exit::kTemporary, "all event streams are taken: close one");
      busy.headers["Retry-After"] = "30";
      return send(connection, exchange, std::move(busy));
    }
    Response response;
    response.content_type = "text/event-stream";
    response.headers["X-Accel-Buffering"] = "no";  // a proxy that gathers would delay events
    MHD_Response* const to = MHD_create_response_from_callback(
        MHD_SIZE_UNKNOWN, kStreamBlockBytes, &readStream,
        new OpenStream{desk_.events, std::move(stream), connection}, &closeStream);
    if (to == nullptr) return MHD_NO;
    addHeaders(to, response);
    desk_.connections.markStream(exchange.connection);
    desk_.metrics.counter("patina_http_requests_total", {"200"}).add();
    const MHD_Result result = MHD_queue_response(connection, 200, to);
    MHD_destroy_response(to);
    return result;
  }

  void setDeadline(const Exchange& exchange, std::chrono::seconds in) {
    desk_.connections.setDeadline(exchange.connection, desk_.clock.mono() + in);
  }

  ListenerOptions options_;
  const Desk desk_;
  MHD_Daemon* daemon_ = nullptr;
};

Listener::Listener(devices::Descriptor socket, ListenerOptions options, const Desk& desk)
    : impl_(std::make_unique<Impl>(std::move(socket), std::move(options), desk)) {}

Listener::~Listener() = default;

}  // namespace patina::http
