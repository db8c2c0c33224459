// SPDX-License-Identifier: GPL-3.0-or-later
// patina alerts test PLAN: one message through every channel of the plan, and what each answered.
#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"
#include "capture/notify/channels.h"
#include "capture/notify/run_notices.h"

namespace patina::app {
namespace {

namespace notify = capture::notify;

struct TestOptions {
  std::string plan;
  std::string sendmail = notify::kSendmail;  // hidden: for tests
};

void answer(Context& context, const std::string& channel, bool delivered, const std::string& text) {
  if (!delivered) context.exit_code = static_cast<int>(Exit::kUnavailable);
  context.out.add(std::move(Item()
                                .set("channel", channel.c_str())
                                .set("delivered", Value{delivered}, delivered ? "yes" : "NO")
                                .set("answer", text.c_str())));
}

void test(Context& context, const TestOptions& options) {
  const capture::Plan plan = capture::readPlan(options.plan);
  const devices::RigSpec rig = devices::readRig(plan.rig_file);
  if (!plan.alerts.anyChannel())
    throw AppError(
        Exit::kConfig,
        options.plan + ": [alerts] names no channel; examples/alerts/plan.toml has some");
  notify::Message message;
  message.about = notify::aboutOf(plan, rig, "none");
  message.utc = context.clock.utc();
  const notify::Channels channels =
      notify::openChannels(plan.alerts, message.about, notify::inventoryOf(rig),
                           notify::Mqtt::Purpose::kTest, options.sendmail);
  std::stop_source hurry;
  context.signals.onStop([&hurry] { hurry.request_stop(); });
  for (const std::string& problem : channels.problems) {
    const std::size_t colon = problem.find(": ");
    answer(context, problem.substr(0, colon), false, problem.substr(colon + 2));
  }
  for (const auto& channel : channels.open) {
    const notify::Delivery delivery = channel->send(message, hurry.get_token());
    answer(context, channel->name(), delivery.delivered(), delivery.answer);
  }
  context.signals.onStop({});
}

}  // namespace

void addAlertsVerbs(Verb root) {
  Verb alerts = root.group("alerts", "Alerts: what a run tells people, and how");
  auto options = std::make_shared<TestOptions>();
  alerts
      .verb("test", "One message through every channel of the plan, and what each answered",
            "patina alerts test examples/alerts/plan.toml",
            [options](Context& context) { test(context, *options); })
      .required("PLAN", options->plan, "The plan's .toml file")
      .option("--sendmail", options->sendmail, "FILE", "The program that takes mail")
      .conceal("--sendmail");
}

}  // namespace patina::app
