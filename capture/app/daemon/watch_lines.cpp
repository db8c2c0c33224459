// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/watch_lines.h"

#include "capture/app/daemon/json_rows.h"

namespace patina::daemon {
namespace {

constexpr int kNoLimit = 1'000'000;
constexpr std::size_t kSeconds = 19;  // of "2024-05-01T12:00:00.000Z"

std::string timeOf(UtcTime utc) { return formatUtc(utc).substr(0, kSeconds); }

std::string countsOf(const capture::SessionStatus& s) {
  std::string text = "captured " + std::to_string(s.captured);
  for (const auto& [name, count] : {std::pair{"held", s.held},
                                    {"missed", s.missed},
                                    {"skipped", s.skipped},
                                    {"failed", s.failed}})
    if (count > 0) text += std::string("  ") + name + " " + std::to_string(count);
  return text;
}

std::string runLine(const RunView& view) {
  const capture::SessionStatus& s = view.status;
  const bool waits = !view.active && (view.state == "running" || view.state == "paused");
  std::string line = view.id + "  " + view.state + (waits ? " (waiting)" : "");
  if (s.steps == 0) return line;  // no session has told of itself
  line += "  step " + std::to_string(s.step) + "/" + std::to_string(s.steps);
  if (view.active) line += "  next " + timeOf(s.next_due_utc);
  return line + "  " + countsOf(s);
}

std::string cameraLine(const CameraView& camera) {
  std::string line = "  " + camera.status.id + (camera.status.up ? "  up" : "  DOWN") + "  shots " +
                     std::to_string(camera.captured);
  if (camera.failed > 0) line += "  failed " + std::to_string(camera.failed);
  if (camera.newest) line += "  newest " + timeOf(camera.newest->utc);
  if (!camera.status.trouble.empty()) line += "  " + camera.status.trouble;
  return line;
}

// A stranger's file name, or a driver's message, must not steer the terminal.
std::string plain(std::string line, int columns) {
  for (char& c : line)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  const auto most = static_cast<std::size_t>(columns > 0 ? columns : 80);
  return line.size() > most ? line.substr(0, most) : line;
}

std::string member(const std::vector<std::pair<std::string, std::string>>& members,
                   const char* key) {
  for (const auto& [name, value] : members)
    if (name == key) return value;
  return {};
}

}  // namespace

std::vector<std::string> WatchLines::take(const std::vector<RunView>& runs) {
  std::vector<std::string> lines;
  for (const RunView& view : runs) {
    if (only_.empty() && !view.active && view.trouble.empty()) continue;
    if (std::string line = plain(changeOf(view), kNoLimit); !line.empty())
      lines.push_back(std::move(line));
  }
  return lines;
}

std::string WatchLines::changeOf(const RunView& view) {
  if (!only_.empty() && view.id != only_) return {};
  const auto known = runs_.find(view.id);
  const bool same = known != runs_.end() && known->second.state == view.state &&
                    known->second.active == view.active && known->second.trouble == view.trouble &&
                    known->second.status.step == view.status.step &&
                    known->second.status.note == view.status.note;
  runs_[view.id] = view;
  const bool ended = view.state == "finished" || view.state == "aborted" || view.state == "stopped";
  if (!only_.empty() && ended && !view.active) over_ = true;
  if (same) return {};
  std::string line = runLine(view);
  if (!view.status.light.empty()) line += "  light " + view.status.light;
  if (!view.status.note.empty()) line += "  " + view.status.note;
  if (!view.trouble.empty()) line += "  trouble: " + view.trouble;
  return line;
}

std::string WatchLines::alertOf(const std::string& json) {
  const auto members = membersOf(json);
  const std::string run_id = member(members, "run_id"), what = member(members, "what");
  if (!only_.empty() && run_id != only_) return {};
  const std::string key = run_id + " " + what;
  if (member(members, "over") == "true") {
    alerts_.erase(key);
    return run_id + "  over: " + what;
  }
  alerts_[key] = member(members, "detail");
  return run_id + "  ALERT " + what + ": " + alerts_[key];
}

std::string WatchLines::take(const std::string& event, const std::string& json) {
  std::string line;
  if (event == "alert") line = alertOf(json);
  if (event == "run" || event == "status")
    if (const auto view = runOf(json)) line = changeOf(*view);
  return plain(line, kNoLimit);
}

std::vector<std::string> WatchLines::screen(int columns) const {
  std::vector<std::string> lines;
  for (const auto& [id, view] : runs_) {
    if (!view.active && view.trouble.empty() && only_.empty()) continue;
    lines.push_back(runLine(view));
    for (const CameraView& camera : view.cameras) lines.push_back(cameraLine(camera));
    std::string rest = "  light " + (view.status.light.empty() ? "-" : view.status.light);
    if (view.status.disk_free_bytes > 0)
      rest += "  disk " + formatBytes(view.status.disk_free_bytes);
    if (!view.status.note.empty()) rest += "  " + view.status.note;
    if (!view.trouble.empty()) rest += "  trouble: " + view.trouble;
    lines.push_back(rest);
  }
  for (const auto& [key, detail] : alerts_)
    lines.push_back(std::string("  ! ").append(key).append(": ").append(detail));
  if (lines.empty()) lines.emplace_back("no run is going on");
  for (std::string& line : lines) line = plain(line, columns);
  return lines;
}

}  // namespace patina::daemon
