// SPDX-License-Identifier: GPL-3.0-or-later
// What may be asked: POST, for operators. Each may be asked twice.
#include <algorithm>

#include "capture/app/daemon/handlers.h"
#include "capture/app/http/json_text.h"

namespace patina::daemon {
namespace {

using http::Request;
using http::Response;
using http::Role;

Response runResponse(const RunView& view) {
  Response response;
  response.body = listJson("run", {jsonOf(view)});
  return response;
}

// From the network only what was laid out for it: a path is a way to read any file, and a rig names
// devices. Links are followed before the question is asked.
std::filesystem::path allowedPlan(const Surroundings& around, const Request& request,
                                  const std::filesystem::path& asked) {
  if (request.local && asked.is_absolute()) return asked;
  const std::filesystem::path folder = around.plans();
  if (folder.empty())
    throw capture::CaptureError(Exit::kPermission,
                                "no plans are laid out for the network: start the daemon with "
                                "--plans DIR, or start the run on its machine");
  std::error_code error;
  const auto root = std::filesystem::weakly_canonical(folder, error);
  auto plan = std::filesystem::weakly_canonical(root / asked, error);
  const auto [end, unused] = std::mismatch(root.begin(), root.end(), plan.begin(), plan.end());
  if (error || end != root.end() || plan == root)
    throw capture::CaptureError(Exit::kPermission, "that plan does not lie in the folder of plans");
  return plan;
}

Response start(const Surroundings& around, const Request& request) {
  const auto wish = startWishOf(request.body);
  if (!wish)
    throw capture::CaptureError(
        Exit::kUsage, "the body is {\"plan\": \"FILE.toml\", \"new_run\": false, \"wait\": false}");
  return runResponse(
      around.keeper.start(allowedPlan(around, request, wish->plan), {wish->new_run, wish->wait}));
}

// The archive knows no such run, or several: not found. A run that has ended is a bad request.
Response ask(const Surroundings& around, const Request& request,
             RunView (RunKeeper::*wish)(const std::string&)) {
  try {
    return runResponse((around.keeper.*wish)(request.parameters.at("run")));
  } catch (const db::ArchiveError& error) {
    if (error.exit() == Exit::kUsage) return http::errorResponse(404, error.exit(), error.what());
    throw;
  }
}

}  // namespace

std::vector<http::Route> askingRoutes(Surroundings& around) {
  std::vector<http::Route> routes;
  routes.push_back({"POST", "/api/v1/runs", Role::kOperator, "startRun",
                    [&around](const Request& request) { return start(around, request); }});
  const auto add = [&](const char* verb, const char* id,
                       RunView (RunKeeper::*wish)(const std::string&)) {
    routes.push_back(
        {"POST", std::string("/api/v1/runs/{run}/") + verb, Role::kOperator, id,
         [&around, wish](const Request& request) { return ask(around, request, wish); }});
  };
  add("pause", "pauseRun", &RunKeeper::pause);
  add("resume", "resumeRun", &RunKeeper::resume);
  add("stop", "stopRun", &RunKeeper::stop);
  add("abort", "abortRun", &RunKeeper::abort);
  add("shoot", "shootNow", &RunKeeper::shoot);
  routes.push_back(
      {"POST", "/api/v1/reload", Role::kAdmin, "reloadConfiguration", [&around](const Request&) {
         Response response;
         response.body =
             listJson("reload", {"{\"changed\":" + http::jsonString(around.reload()) + "}"});
         return response;
       }});
  return routes;
}

std::vector<http::Route> routesOf(Surroundings& around) {
  std::vector<http::Route> routes = readingRoutes(around);
  for (http::Route& route : askingRoutes(around)) routes.push_back(std::move(route));
  return routes;
}

}  // namespace patina::daemon
