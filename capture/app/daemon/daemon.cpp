// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/daemon.h"

#include <malloc.h>

#include <mutex>

#include "capture/app/daemon/after_retries.h"
#include "capture/app/daemon/after_work.h"
#include "capture/app/daemon/broadcast.h"
#include "capture/app/daemon/daemon_config.h"
#include "capture/app/daemon/handlers.h"
#include "capture/app/daemon/inhibitor.h"
#include "capture/app/daemon/places.h"
#include "capture/app/daemon/run_keeper.h"
#include "capture/app/daemon/scrub_watch.h"
#include "capture/app/daemon/service.h"
#include "capture/app/http/server.h"
#include "capture/app/rig/attached.h"
#include "devices/scaled_clock.h"

namespace patina::daemon {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kRetryEvery = 30s;
constexpr const char* kMainLoop = "main loop";

// From a frame's bytes to its acknowledgement; points of one frame come on one thread.
std::function<void(db::CommitPoint)> commitTimer(devices::Clock& real, Broadcast& broadcast,
                                                 std::function<void(db::CommitPoint)> then) {
  return [&real, &broadcast, then = std::move(then)](db::CommitPoint point) {
    if (then) then(point);
    thread_local std::optional<MonoTime> began;
    if (point == db::CommitPoint::kTmpWritten && !began) began = real.mono();
    if (point != db::CommitPoint::kCommitted || !began) return;
    broadcast.committed(real.mono() - *began);
    began.reset();
  };
}

// Heaps keep what they have. To give memory back and take it again is done under the lock of the
// whole address space, and a thread of HTTP that holds it may not be let run for long. Bodies of
// requests are larger than what is kept.
void keepHeaps() {
  mallopt(M_TRIM_THRESHOLD, 32 << 20);
  mallopt(M_MMAP_THRESHOLD, 1 << 20);
}

bool hasProductsDue(const db::RunRow& run) {
  if (run.state != "finished" || run.boot_id == "import") return false;
  try {
    return !capture::parsePlan(run.plan_toml, "plan.toml").after.empty();
  } catch (const Failure&) {
    return false;  // of an older program: nothing is made of it without being asked for
  }
}

std::string productsOf(const std::string& run_id) { return "products of " + run_id + " failed"; }

}  // namespace

class Daemon::Impl {
 public:
  Impl(const DaemonOptions& options, devices::Clock& real)
      : options_(options),
        real_(real),
        config_(options.config, options.plans),
        watchdog_(real),
        broadcast_(metrics_, watchdog_),
        acks_(options.log_acks) {
    keepHeaps();
    if (options.speed > 0) scaled_ = std::make_unique<devices::ScaledClock>(real, options.speed);
    started_ = clock().utc();
    db::ArchiveOptions opening;
    opening.folder = options.archive;
    opening.owner = options.command;
    opening.at_point = commitTimer(real, broadcast_, options.at_point);
    archive_ = std::make_unique<db::Archive>(opening);
    broadcast_.logAcks(&acks_);
    broadcast_.showIn(&previews_);
    keep();
    listen();
  }

  ~Impl() {
    broadcast_.publishTo({});
    broadcast_.onChange({});
    server_.reset();  // no handler is at work after this
    keeper_.reset();
    dispatcher_.reset();
    after_.reset();
    feeding_.reset();
  }

  void run(const std::stop_token& stop);

  std::string reload() {
    std::string told = config_.reload();
    options_.say("reloaded: " + told);
    return told;
  }
  int port() const { return server_->port(); }

 private:
  devices::Clock& clock() { return scaled_ ? *scaled_ : real_; }
  void keep();
  void listen();
  void afterwards(const std::string& run_id, const std::string& trouble);
  std::string tryAgain(const std::string& run_id, const std::string& trouble);
  void finishWhatWasLeft();
  void everyHalfMinute();
  void lookForDamage();
  void wake();
  void beat(MonoTime& retried);
  DaemonStatus status();

  const DaemonOptions options_;
  devices::Clock& real_;
  std::unique_ptr<devices::ScaledClock> scaled_;
  LiveConfig config_;
  http::Metrics metrics_;
  Watchdog watchdog_;
  Broadcast broadcast_;
  const AckLog acks_;
  Previews previews_;
  RunCounts counts_;
  Inhibitor inhibitor_;
  UtcTime started_;
  std::unique_ptr<db::Archive> archive_;
  ScrubWatch scrubs_;
  AfterRetries retries_;
  std::unique_ptr<AfterWork> feeding_, after_;
  std::unique_ptr<capture::notify::Dispatcher> dispatcher_;
  std::unique_ptr<RunKeeper> keeper_;
  std::optional<Surroundings> around_;
  std::unique_ptr<http::Server> server_;
  std::mutex wake_mutex_;
  std::stop_source wake_;  // a new one a turn of the loop
};

void Daemon::Impl::keep() {
  after_ = std::make_unique<AfterWork>(
      options_.after_command,
      [this](const std::string& run, const std::string& trouble) { afterwards(run, trouble); });
  std::vector<std::string> so_far = options_.after_command;
  so_far.emplace_back("--so-far");
  // What fails is tried again with the next step, and told when the run is over.
  feeding_ = std::make_unique<AfterWork>(so_far, [](const std::string&, const std::string&) {});
  dispatcher_ = std::make_unique<capture::notify::Dispatcher>(clock());
  dispatcher_->start();
  KeeperOptions keeping{*archive_, clock(), broadcast_, openRig, {}, dispatcher_.get(), {}, {}};
  if (options_.speed > 0)
    keeping.open_rig = openTwinOnly;
  else
    keeping.require_cameras = [](const devices::RigSpec& rig, devices::Clock& real) {
      rig::requireCameras(rig, real);
    };
  keeping.stepped = [this](const std::string& run_id) { feeding_->add(run_id); };
  keeping.finished = [this](const std::string& run_id) {
    notifyStatus("making products");  // at once: they may be made before the main loop turns
    after_->add(run_id);
  };
  keeper_ = std::make_unique<RunKeeper>(keeping);
  broadcast_.onChange([this] { wake(); });
}

void Daemon::Impl::listen() {
  const DaemonConfig config = config_.get();
  const Places places = placesToListen(options_.archive);
  around_.emplace(Surroundings{archive_->reader().folder(), *keeper_, broadcast_, previews_,
                               counts_, [this] { return status(); },
                               [this] { return config_.get().plans; },
                               [this] { return reload(); }});
  http::ServerOptions serving;
  serving.socket = places.socket;
  serving.token_file = places.token;
  serving.listen = config.listen;
  serving.port = options_.port.value_or(config.port);
  serving.behind_proxy = config.behind_proxy;
  serving.tls_certificate = config.tls_certificate;
  serving.tls_key = config.tls_key;
  serving.host_names = config.host_names;
  serving.archive = archive_->reader().folder();
  metrics_.gauge("patina_up").set(1);
  server_ = std::make_unique<http::Server>(serving, routesOf(*around_), real_, metrics_);
  broadcast_.publishTo(
      [this](const std::string& event, const std::string& json) { server_->publish(event, json); });
  options_.say("listening on " + places.socket.string() +
               (serving.listen.empty()
                    ? ""
                    : " and " + serving.listen + ":" + std::to_string(server_->port())));
}

// "; tried again in 10min". What fails is an alert until a try of ours makes it.
std::string Daemon::Impl::tryAgain(const std::string& run_id, const std::string& trouble) {
  const auto wait = retries_.failed(run_id, real_.mono());
  std::string next = wait ? "; tried again in " + capture::formatLasted(*wait)
                          : "; given up: `patina run after " + run_id + "` says why";
  broadcast_.warn(productsOf(run_id), trouble + next, clock().utc());
  return next;
}

// Whatever became of them, it is known in the archive: a restart makes only what is missing.
void Daemon::Impl::afterwards(const std::string& run_id, const std::string& trouble) {
  db::EventRow event;
  event.run_id = run_id;
  event.utc = clock().utc();
  event.kind = "after";
  event.detail = trouble.empty() ? "done" : "failed: " + trouble + tryAgain(run_id, trouble);
  options_.say("products of " + run_id + ": " + event.detail);
  if (trouble.empty()) {
    retries_.done(run_id);
    broadcast_.settled(productsOf(run_id));
  }
  try {
    archive_->addEvent(event);
  } catch (const db::ArchiveError& error) {
    options_.say(error.what());
  }
  wake();
}

void Daemon::Impl::finishWhatWasLeft() {
  for (const db::RunRow& run : archive_->reader().runs()) {
    if (!hasProductsDue(run)) continue;
    bool done = false;
    for (const db::EventRow& event : archive_->reader().events(run.id))
      done = done || (event.kind == "after" && event.detail == "done");
    if (!done) after_->add(run.id);
  }
}

DaemonStatus Daemon::Impl::status() {
  DaemonStatus status;
  status.version = options_.version;
  status.archive = archive_->reader().folder().string();
  status.now = clock().utc();
  status.started = started_;
  for (const RunView& view : keeper_->runs()) status.runs_active += view.active ? 1 : 0;
  status.alerts_active = static_cast<std::int64_t>(broadcast_.alerts().size());
  status.disk_free_bytes = archive_->space().free_bytes;
  return status;
}

void Daemon::Impl::wake() {
  const std::lock_guard lock(wake_mutex_);
  wake_.request_stop();
}

// One turn of the main loop: what the service manager and the sleep of the machine hang on.
void Daemon::Impl::beat(MonoTime& retried) {
  watchdog_.turned(kMainLoop);
  std::string told;
  int active = 0;
  for (const RunView& view : keeper_->runs()) {
    told += (told.empty() ? "" : "; ") + view.id + " " + view.state;
    if (view.active) {
      ++active;
      told +=
          ", step " + std::to_string(view.status.step) + " of " + std::to_string(view.status.steps);
    } else {
      told += ": " + view.trouble;
    }
  }
  if (after_->waiting() > 0) told += (told.empty() ? "" : "; ") + std::string("making products");
  notifyStatus(told.empty() ? "no run" : told);
  if (active == 0)
    inhibitor_.release();
  else if (const std::string why = inhibitor_.take(); !why.empty())
    options_.say(why);
  if (real_.mono() - retried < kRetryEvery) return;
  retried = real_.mono();
  everyHalfMinute();
}

void Daemon::Impl::everyHalfMinute() {
  keeper_->retry();
  for (const std::string& run_id : retries_.due(real_.mono())) after_->add(run_id);
  lookForDamage();
}

void Daemon::Impl::lookForDamage() {
  for (const db::EventRow& damage : scrubs_.news(archive_->reader()))
    broadcast_.damaged(damage.detail, damage.utc);
}

void Daemon::Impl::run(const std::stop_token& stop) {
  watchdog_.begin(kMainLoop);
  keeper_->takeUp();
  if (!options_.start.empty()) {
    // After a reboot cameras may come later than we do, and the runs taken up must not end for it.
    const RunView view = keeper_->start(options_.start, {.new_run = false, .wait = true});
    options_.say("run " + view.id + " goes on");
  }
  lookForDamage();
  finishWhatWasLeft();
  notifyReady("ready");
  const std::stop_callback on_stop(stop, [this] { wake(); });
  MonoTime retried = real_.mono();
  while (!stop.stop_requested() && !keeper_->broken()) {
    std::stop_token woken;
    {
      const std::lock_guard lock(wake_mutex_);
      wake_ = std::stop_source();
      woken = wake_.get_token();
    }
    if (stop.stop_requested()) break;  // before the new source was there to be told
    beat(retried);
    real_.sleepUntil(real_.mono() + watchdog_.patience(), woken);
  }
  notifyStopping();
  watchdog_.end(kMainLoop);
  keeper_->shutDown();
  if (keeper_->broken())
    throw db::ArchiveError(Exit::kIo, "the disk of " + options_.archive.string() +
                                          " failed: start again, which recovers what was "
                                          "acknowledged");
}

Daemon::Daemon(const DaemonOptions& options, devices::Clock& real)
    : impl_(std::make_unique<Impl>(options, real)) {}
Daemon::~Daemon() = default;
void Daemon::run(const std::stop_token& stop) { impl_->run(stop); }
std::string Daemon::reload() { return impl_->reload(); }
int Daemon::port() const { return impl_->port(); }

}  // namespace patina::daemon
