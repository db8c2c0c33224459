// SPDX-License-Identifier: GPL-3.0-or-later
// What may be seen: GET, for viewers.
#include <charconv>
#include <utility>

#include "capture/app/daemon/handlers.h"
#include "db/archive_pages.h"

namespace patina::daemon {
namespace {

using http::Request;
using http::Response;
using http::Role;

Response json(std::string body) {
  Response response;
  response.body = std::move(body);
  return response;
}

Response notThere(const std::string& what) {
  return http::errorResponse(404, Exit::kUsage, what + " is not in the archive");
}

std::optional<db::RunRow> findRun(const db::ArchiveReader& reader, const Request& request) {
  try {
    return reader.findRun(request.parameters.at("run"));
  } catch (const db::ArchiveError& error) {
    if (error.exit() == Exit::kUsage) return std::nullopt;
    throw;
  }
}

std::int64_t numberOf(const Request& request, const char* name, std::int64_t fallback,
                      std::int64_t least, std::int64_t most) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return fallback;
  const std::string& text = found->second;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < least || value > most)
    throw capture::CaptureError(Exit::kUsage, std::string(name) + " is a whole number, " +
                                                  std::to_string(least) + " to " +
                                                  std::to_string(most));
  return value;
}

db::ArchivePages::Page pageOf(const Request& request) {
  return {numberOf(request, "after", -1, -1, INT64_MAX),
          static_cast<int>(numberOf(request, "limit", 100, 1, db::kPageRowsMax))};
}

// A list of the run {run}, and, when it fills its page, where the next one begins.
template <class Ask, class KeyOf>
Response pageResponse(const Surroundings& around, const Request& request, const char* name, Ask ask,
                      KeyOf key_of) {
  const db::ArchiveReader reader(around.archive);
  const auto run = findRun(reader, request);
  if (!run) return notThere("that run");
  const auto page = pageOf(request);
  const auto rows = ask(db::ArchivePages(reader), run->id, page);
  std::vector<std::string> items;
  for (const auto& row : rows) items.push_back(jsonOf(row));
  std::optional<std::int64_t> next;
  if (rows.size() == static_cast<std::size_t>(page.rows)) next = key_of(rows.back());
  return json(listJson(name, items, next));
}

std::string runJson(const Surroundings& around, const db::ArchiveReader& reader,
                    const db::RunRow& row, const RunView* live) {
  return jsonOf(row, live, hasSpoken(live) ? live->status : around.counts.of(reader, row));
}

Response runList(const Surroundings& around, const Request& request) {
  const auto page = pageOf(request);
  const auto live = around.keeper.runs();
  std::vector<std::string> items;
  std::optional<std::int64_t> next;
  const db::ArchiveReader reader(around.archive);
  for (const db::RunRow& row : reader.runs()) {
    if (row.number <= page.after) continue;
    if (items.size() == static_cast<std::size_t>(page.rows)) break;
    if (items.size() + 1 == static_cast<std::size_t>(page.rows)) next = row.number;
    const RunView* view = nullptr;
    for (const RunView& candidate : live)
      if (candidate.id == row.id) view = &candidate;
    items.push_back(runJson(around, reader, row, view));
  }
  return json(listJson("runs", items, next));
}

Response oneRun(const Surroundings& around, const Request& request) {
  const db::ArchiveReader reader(around.archive);
  const auto row = findRun(reader, request);
  if (!row) return notThere("that run");
  const auto live = around.keeper.runs();
  for (const RunView& view : live)
    if (view.id == row->id) return json(listJson("run", {runJson(around, reader, *row, &view)}));
  return json(listJson("run", {runJson(around, reader, *row, nullptr)}));
}

Response deviceList(const Surroundings& around) {
  const auto live = around.keeper.runs();
  std::vector<std::string> items;
  const db::ArchiveReader reader(around.archive);
  for (const db::DeviceRow& device : db::ArchivePages(reader).devices()) {
    std::string held_by;
    for (const RunView& view : live)
      for (const std::string& id : view.devices)
        if (id == device.id) held_by = view.id;
    items.push_back(jsonOf(device, held_by));
  }
  return json(listJson("devices", items));
}

Response alertList(const Surroundings& around) {
  std::vector<std::string> items;
  for (const Alert& alert : around.broadcast.alerts()) items.push_back(jsonOf(alert, false));
  return json(listJson("alerts", items));
}

Response original(const Surroundings& around, const Request& request) {
  const std::string& hex = request.parameters.at("sha256");
  const db::ArchiveReader reader(around.archive);
  const auto frame = db::ArchivePages(reader).frameOf(Sha256::fromHex(hex));
  if (!frame) return notThere(hex);
  Response response;
  response.content_type = "application/octet-stream";
  response.headers["ETag"] = "\"" + hex + "\"";
  response.headers["Content-Disposition"] =
      "attachment; filename=\"" + hex.substr(0, 16) + "." + frame->ext + "\"";
  response.file = reader.pathOf(*frame);
  return response;
}

Response preview(const Surroundings& around, const Request& request) {
  const std::string& hex = request.parameters.at("sha256");
  const int width = static_cast<int>(numberOf(request, "width", 256, 16, 1024));
  const db::ArchiveReader reader(around.archive);
  const auto frame = db::ArchivePages(reader).frameOf(Sha256::fromHex(hex));
  if (!frame) return notThere(hex);
  Response response = json(around.previews.jpeg(reader, *frame, width));
  response.content_type = "image/jpeg";
  response.headers["ETag"] = "\"" + hex + "-" + std::to_string(width) + "\"";
  response.headers["Cache-Control"] = "private, max-age=86400";
  return response;
}

std::vector<http::Route> listsOfARun(Surroundings& around) {
  const auto list = [&around](const char* path, const char* id, const char* name, auto ask,
                              auto key_of) {
    return http::Route{"GET", std::string("/api/v1/runs/{run}/") + path, Role::kViewer, id,
                       [&around, name, ask, key_of](const Request& request) {
                         return pageResponse(around, request, name, ask, key_of);
                       }};
  };
  using Pages = db::ArchivePages;
  using Page = Pages::Page;
  const auto id_of = [](const auto& row) { return row.id; };
  return {
      list(
          "steps", "listSteps", "steps",
          [](const Pages& pages, const std::string& run, const Page& page) {
            return pages.steps(run, page);
          },
          [](const db::StepRow& row) { return row.number.value_or(-1); }),
      list(
          "light", "listLight", "light",
          [](const Pages& pages, const std::string& run, const Page& page) {
            return pages.lightChecks(run, page);
          },
          id_of),
      list(
          "events", "listRunEvents", "events",
          [](const Pages& pages, const std::string& run, const Page& page) {
            return pages.events(run, page);
          },
          id_of),
      list(
          "frames", "listFrames", "frames",
          [](const Pages& pages, const std::string& run, const Page& page) {
            return pages.frames(run, page);
          },
          [](const Pages::ShotFrame& row) { return row.frame.id; }),
  };
}

}  // namespace

std::vector<http::Route> readingRoutes(Surroundings& around) {
  std::vector<http::Route> routes = listsOfARun(around);
  const auto get = [&routes](const char* path, const char* id,
                             std::function<Response(const Request&)> handler) {
    routes.push_back(
        {"GET", std::string("/api/v1/") + path, Role::kViewer, id, std::move(handler)});
  };
  get("status", "getStatus",
      [&around](const Request&) { return json(listJson("status", {jsonOf(around.status())})); });
  get("runs", "listRuns", [&around](const Request& r) { return runList(around, r); });
  get("runs/{run}", "getRun", [&around](const Request& r) { return oneRun(around, r); });
  get("devices", "listDevices", [&around](const Request&) { return deviceList(around); });
  get("alerts", "listAlerts", [&around](const Request&) { return alertList(around); });
  get("objects/{sha256}", "getObject", [&around](const Request& r) { return original(around, r); });
  get("objects/{sha256}/preview", "getPreview",
      [&around](const Request& r) { return preview(around, r); });
  return routes;
}

}  // namespace patina::daemon
