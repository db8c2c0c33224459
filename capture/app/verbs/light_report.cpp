// SPDX-License-Identifier: GPL-3.0-or-later
// patina light report RUN: what the light of a run did.
#include "capture/workflow/light_report.h"

#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/pictures.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

struct Options {
  std::string run = "latest", out;
};

void report(Context& context, const Options& options) {
  const db::ArchiveReader reader(context.archive());
  const workflow::LightReport report =
      workflow::reportLight(reader, reader.findRun(options.run).id);
  if (!options.out.empty()) {
    const Image<std::uint8_t> chart = workflow::drawLight(report);
    writePng(options.out, chart.view());
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
        .set("gain_max", Value{series.gain_max});
    context.out.add(std::move(item));
  }
}

}  // namespace

void addLightVerbs(Verb root) {
  Verb light = root.group("light", "The light of a run");
  auto o = std::make_shared<Options>();
  light
      .verb("report", "Its verdicts, in sentences, a table and a chart",
            "patina light report latest --archive banana --out light.png",
            [o](Context& context) { report(context, *o); })
      .optional("RUN", o->run, "A run's id, a prefix of one, or latest")
      .option("--out", o->out, "FILE.png", "A chart of it");
}

}  // namespace patina::app
