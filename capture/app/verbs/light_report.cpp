// SPDX-License-Identifier: GPL-3.0-or-later
// patina light report | measure | confirm RUN: what the light of a run did, what it was where
// nobody watched, and whether the lamps that lit it were the right ones.
#include "capture/workflow/light_report.h"

#include "capture/app/context.h"
#include "capture/app/verbs/frame_options.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/lamp_confirmation.h"
#include "capture/workflow/light_gain.h"
#include "capture/workflow/pictures.h"
#include "devices/config_file.h"
#include "devices/rig.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  std::string run = "latest", out;
};

std::vector<std::string> lampsThatStayOn(const db::RunRow& run) {
  std::vector<std::string> lamps;
  if (run.rig_toml.empty()) return lamps;
  for (const devices::LightSpec& light :
       devices::parseRig(run.rig_toml, run.id + ": its rig").lights)
    if (light.between != devices::Between::kOff) lamps.push_back(light.id);
  return lamps;
}

void report(Context& context, const Options& options) {
  const db::ArchiveReader reader(context.archive());
  const db::RunRow run = reader.findRun(options.run);
  const workflow::LightReport report = workflow::reportLight(reader, run.id, lampsThatStayOn(run));
  if (options.out.ends_with(".png")) {
    writePng(options.out, workflow::drawLight(report).view());
  } else if (!options.out.empty()) {
    std::filesystem::create_directories(options.out);
    for (const auto& [name, picture] : workflow::drawLightCharts(report))
      writePng(std::filesystem::path(options.out) / (name + ".png"), picture.view());
  }
  for (const std::string& sentence : report.sentences) context.out.say(sentence);
  for (const workflow::LightSeriesReport& series : report.series) {
    Item item;
    item.hidden("run_id", Value{report.run_id})
        .set("light", series.light.c_str())
        .set("exposure", series.exposure)
        .set("source", series.source.c_str())
        .set("channel", series.channel.c_str())
        .set("checks", series.checks);
    for (const char* verdict : {"learn", "pass", "correct", "hold", "fail", "measure", "saturated",
                                "covered", "at_odds"}) {
      const auto found = series.verdicts.find(verdict);
      const std::int64_t count = found == series.verdicts.end() ? 0 : found->second;
      if (report.verdicts.contains(verdict))
        item.set(verdict, count);
      else
        item.hidden(verdict, Value{count});
    }
    item.set("ratio_min", Value{series.ratio_min})
        .set("ratio_max", Value{series.ratio_max})
        .set("gain_min", Value{series.gain_min})
        .set("gain_max", Value{series.gain_max})
        .set("steps_told", series.charts.told.size())
        .hidden("warm_up_s", Value{toSeconds(series.charts.warm_up.tau)})
        .hidden("warm_up_found", Value{series.charts.warm_up.found})
        .hidden("trusted", Value{report.trusted})
        .hidden("verdict", Value{report.verdict})
        .hidden("sentences", Value{report.sentences});
    context.out.add(std::move(item));
  }
}

struct MeasureOptions : FrameOptions {
  std::string run = "latest";
  RectPx patch;
};

void measure(Context& context, MeasureOptions& options) {
  workflow::LightGainRequest request;
  request.run = options.run;
  request.selection = options.selection;
  request.patch = options.patch;
  request.command = "patina light measure";
  request.version = PATINA_VERSION;
  const workflow::LightGainOutcome outcome =
      workflow::measureLightGain(context.archive(), request, context.clock.utc(), context.progress);
  context.out.asList();
  Item item;
  item.set("id", std::int64_t{outcome.row.id})
      .set("camera", outcome.row.device_id.c_str())
      .set("light", outcome.row.light_state.c_str())
      .set("frames", outcome.frames);
  for (std::size_t c = 0; c < 3; ++c) {
    const std::string channel(1, "rgb"[c]);
    item.set("flicker_" + channel, Value{outcome.flicker[c]})
        .set("gain_min_" + channel, Value{outcome.gain_min[c]})
        .set("gain_max_" + channel, Value{outcome.gain_max[c]});
  }
  item.set("path", outcome.path.c_str());
  context.out.add(std::move(item));
}

struct ConfirmOptions {
  std::string run = "latest";
  workflow::FrameSelection selection;
  int exposure = -1;
};

void confirm(Context& context, ConfirmOptions& options) {
  const db::ArchiveReader reader(context.archive());
  if (options.exposure >= 0) options.selection.exposure = options.exposure;
  const workflow::LampConfirmation found = workflow::confirmLamps(
      reader, reader.findRun(options.run).id, options.selection, context.progress);
  for (const std::string& one : found.told) context.out.say(one);
  context.out.say(found.verdict());
  for (const workflow::StateConfirmation& state : found.states)
    context.out.add(std::move(Item()
                                  .set("camera", found.camera.c_str())
                                  .set("light", state.light.c_str())
                                  .set("frames", state.frames)
                                  .set("confirmed", state.confirmed)
                                  .set("other", state.other)
                                  .set("dark", state.dark)
                                  .set("unclear", state.unclear)
                                  .set("margin_least", Value{state.margin_least})
                                  .hidden("verdict", Value{found.verdict()})
                                  .hidden("told", Value{found.told})));
  if (!found.all()) context.exit_code = static_cast<int>(Exit::kBadData);
}

void addConfirm(Verb& light) {
  auto o = std::make_shared<ConfirmOptions>();
  light
      .verb("confirm",
            "Which lamp lit each frame, told by its shading: exit 65 where it is not the one of "
            "its row",
            "patina light confirm latest --archive banana",
            [o](Context& context) { confirm(context, *o); })
      .optional("RUN", o->run, "A run's id, a prefix of one, or latest")
      .option("--camera", o->selection.camera, "ID", "Where a run has several cameras")
      .option("--exposure", o->exposure, 0, 99, "Where it has several exposures: 0 is the first")
      .option("--every", o->selection.every, 1, 1'000'000, "Every n-th of the frames there are");
}

}  // namespace

void addLightVerbs(Verb root) {
  Verb light = root.group("light", "The light of a run");
  auto o = std::make_shared<Options>();
  light
      .verb("report", "Its verdicts, in sentences, a table and charts",
            "patina light report latest --archive banana --out light",
            [o](Context& context) { report(context, *o); })
      .optional("RUN", o->run, "A run's id, a prefix of one, or latest")
      .option("--out", o->out, "FOLDER",
              "Charts: level, EWMA, cumulative sums, colour; or one FILE.png");
  auto m = std::make_shared<MeasureOptions>();
  Verb verb = light.verb(
      "measure",
      "The gain of every frame, from a region that does not change: for imported pictures",
      "patina light measure latest --archive ivy --patch 10,40,100,40",
      [m](Context& context) { measure(context, *m); });
  verb.optional("RUN", m->run, "A run's id, a prefix of one, or latest")
      .option("--patch", m->patch, parseRect, "X,Y,W,H", "The region, pixels from the upper left")
      .demand("--patch");
  addFrameOptions(verb, *m);
  addConfirm(light);
}

}  // namespace patina::app
