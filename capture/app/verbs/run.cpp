// SPDX-License-Identifier: GPL-3.0-or-later
// patina run start | list | status | pause | resume | stop | abort | shoot: asks the daemon.
#include <optional>

#include "capture/app/context.h"
#include "capture/app/daemon/json_rows.h"
#include "capture/app/daemon/places.h"
#include "capture/app/http/client.h"
#include "capture/app/verbs/run_verbs.h"
#include "capture/app/verbs/verbs.h"

namespace patina::app {
namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

Item itemOf(const daemon::RunView& view) {
  const capture::SessionStatus& s = view.status;
  Item item;
  item.set("id", view.id.c_str()).set("state", view.state.c_str());
  item.hidden("active", view.active).hidden("paused", s.paused);
  item.hidden("specimen", view.specimen).hidden("plan", view.plan);
  // What `run stop` and its like answer of a run that no session is at work on has no counts.
  for (const auto& [key, count] : {std::pair{"step", s.step},
                                   {"steps", s.steps},
                                   {"captured", s.captured},
                                   {"held", s.held},
                                   {"skipped", s.skipped},
                                   {"missed", s.missed},
                                   {"failed", s.failed},
                                   {"partial", s.partial}}) {
    if (s.steps > 0)
      item.set(key, count);
    else
      item.set(key, Value{}, "-");
  }
  if (view.active && s.steps > 0)  // its session has told of itself
    item.set("next_due_utc_ns", s.next_due_utc);
  else
    item.set("next_due_utc_ns", Value{}, "-");
  item.set("light", s.light.c_str());
  item.set("devices", Value{view.devices}, joined(view.devices));
  item.set("note", s.note.c_str()).set("trouble", view.trouble.c_str());
  return item;
}

void tellRun(Context& context, const std::string& answer) {
  for (const daemon::RunView& view : daemon::runsOf(answer)) context.out.add(itemOf(view));
}

void start(Context& context, daemon::StartWish wish) {
  wish.plan = std::filesystem::absolute(wish.plan).lexically_normal().string();
  tellRun(context, callDaemon(context, "POST", "/api/v1/runs", daemon::jsonOf(wish)));
}

void list(Context& context) {
  for (const daemon::RunView& view : runsOfDaemon(context)) context.out.add(itemOf(view));
}

void status(Context& context, const std::string& run) {
  if (!run.empty()) {
    context.out.asList();
    return tellRun(context, callDaemon(context, "GET", "/api/v1/runs/" + run));
  }
  std::string told;
  for (const auto& [key, value] : daemon::membersOf(callDaemon(context, "GET", "/api/v1/status"))) {
    if (key == "version") told += "patina " + value;
    if (key == "archive") told += " keeps " + value;
    if (key == "disk_free_bytes") told += ", " + formatBytes(std::stoull(value)) + " free";
  }
  context.out.say(told);
  for (const daemon::RunView& view : runsOfDaemon(context))
    if (view.active || !view.trouble.empty()) context.out.add(itemOf(view));
}

void addWish(Verb& group, const char* name, const char* help) {
  auto run = std::make_shared<std::string>();
  group
      .verb(name, help, std::string("patina run ") + name + " 20240501T120000Z-banana --archive A",
            [run, name](Context& context) {
              tellRun(context,
                      callDaemon(context, "POST", "/api/v1/runs/" + *run + "/" + name, "{}"));
            })
      .required("RUN", *run, "A run: an id, a unique prefix of one, or latest");
}

}  // namespace

std::string callDaemon(const Context& context, const std::string& method, const std::string& path,
                       const std::string& body) {
  http::Client client(daemon::placesToCall(context.archive()).socket);
  const http::Reply reply = client.call(method, path, body);
  if (reply.status < 400) return reply.body;
  const auto error = daemon::errorOf(reply.body);
  if (!error)
    throw AppError(Exit::kUnavailable, "the daemon answers " + std::to_string(reply.status));
  throw AppError(static_cast<Exit>(error->first), error->second);
}

std::vector<daemon::RunView> runsOfDaemon(const Context& context) {
  std::vector<daemon::RunView> all;
  std::optional<std::int64_t> after = -1;
  while (after) {
    const std::string answer =
        callDaemon(context, "GET", "/api/v1/runs?limit=1000&after=" + std::to_string(*after));
    for (daemon::RunView& view : daemon::runsOf(answer)) all.push_back(std::move(view));
    after = daemon::nextOf(answer);
  }
  return all;
}

void addRunVerbs(Verb root) {
  Verb group = root.group("run", "Runs of the daemon: start, see, pause, stop");
  auto wish = std::make_shared<daemon::StartWish>();
  group
      .verb("start", "Starts a plan, or goes on with its unfinished run",
            "patina run start examples/banana/plan.toml --archive banana",
            [wish](Context& context) { start(context, *wish); })
      .required("PLAN", wish->plan, "The plan's .toml file")
      .flag("--new-run", wish->new_run, "Abort an unfinished run of the specimen and begin another")
      .flag("--wait", wish->wait, "Begin although a camera is not there yet, and wait for it");
  group.verb("list", "All runs of the archive", "patina run list --archive banana",
             [](Context& context) { list(context); });
  auto run = std::make_shared<std::string>();
  group
      .verb("status", "What is going on", "patina run status --archive banana",
            [run](Context& context) { status(context, *run); })
      .optional("RUN", *run, "One run alone: an id, a unique prefix of one, or latest");
  addWish(group, "pause", "From the next step on; steps that fall due meanwhile are skipped");
  addWish(group, "resume", "Goes on with a paused or stopped run");
  addWish(group, "stop", "Finishes the frame and stops, until it is resumed");
  addWish(group, "abort", "Cancels the step and ends the run for ever");
  addWish(group, "shoot", "One step at once, between those of the plan");
  addRunWatchVerb(group);
  addRunAfterVerb(group);
}

}  // namespace patina::app
