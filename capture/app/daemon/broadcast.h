// SPDX-License-Identifier: GPL-3.0-or-later
// Tells the world what happens in the runs: events for who listens, metrics for who asks, alerts
// that are on, and the watchdog's pings.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "capture/app/daemon/ack_log.h"
#include "capture/app/daemon/json_rows.h"
#include "capture/app/daemon/preview.h"
#include "capture/app/daemon/run_view.h"
#include "capture/app/daemon/service.h"
#include "capture/app/http/metrics.h"

namespace patina::daemon {

// Events: "run" (a state), "status", "step", "light", "alert", "frame"; each one JSON object.
class Broadcast final : public RunObserver {
 public:
  using Publish = std::function<void(const std::string& event, const std::string& json)>;
  Broadcast(http::Metrics& metrics, Watchdog& watchdog);

  // None until there is a server, none after it is gone.
  void publishTo(Publish publish);
  // Called when a run's state or session changes, on any thread.
  void onChange(std::function<void()> call);
  void logAcks(const AckLog* log) { ack_log_ = log; }  // before the first run; outlives the runs
  void showIn(Previews* previews) { previews_ = previews; }  // likewise
  std::vector<Alert> alerts() const;
  // What is wrong with the archive as a whole, or stays wrong when a run is over: until settled().
  void warn(const std::string& what, const std::string& detail, UtcTime utc);
  void settled(const std::string& what);
  void damaged(const std::string& detail, UtcTime utc);  // a scrub met a file that was changed
  void committed(Nanoseconds took);  // one frame, from its bytes to its acknowledgement

  void onRun(const RunView& view) override;
  void onStatus(const RunView& view) override;
  void onStep(const db::StepRow& step) override;
  void onShot(const db::ShotRow& shot) override;
  void onFrame(const std::string& run_id, const std::string& camera,
               const db::FrameRow& frame) override;
  void onThumbnail(const Sha256& frame, const Bytes& jpeg) override;
  void onLight(std::span<const db::LightCheckRow> rows) override;
  void onEvent(const db::EventRow& event) override;
  void onAlert(const std::string& run_id, const capture::AlertNews& news) override;
  void onSession(const std::string& run_id, Phase phase) override;

 private:
  void publish(const std::string& event, const std::string& json);
  void put(const Alert& alert, bool over);
  void predictFull(const std::string& run_id, std::optional<UtcTime> full, UtcTime now);

  http::Metrics& metrics_;
  Watchdog& watchdog_;
  const AckLog* ack_log_ = nullptr;
  Previews* previews_ = nullptr;
  mutable std::mutex mutex_;  // guards what follows
  Publish publish_;
  std::function<void()> changed_;
  std::map<std::string, Alert> alerts_;  // by run (empty: of none) and what
  std::set<std::string> just_shot_;      // runs whose step was shot, and not yet counted as late
  std::map<std::string, Nanoseconds> until_full_;  // by run that would not fit
};

}  // namespace patina::daemon
