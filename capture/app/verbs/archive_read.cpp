// SPDX-License-Identifier: GPL-3.0-or-later
// patina archive list | show | query: what is in an archive; also while a run goes on.
#include <algorithm>

#include "capture/app/context.h"
#include "capture/app/verbs/archive_verbs.h"
#include "capture/workflow/product_calibrations.h"
#include "capture/workflow/products.h"
#include "db/archive.h"

namespace patina::app {
namespace {

struct Counts {
  std::int64_t of[6] = {}, partial = 0, steps = 0;
  explicit Counts(const std::vector<db::StepRow>& rows) {
    for (const db::StepRow& row : rows) {
      ++of[static_cast<int>(row.decision)];
      ++steps;
      partial += row.shots_captured > 0 && row.shots_captured < row.shots_due;
    }
  }
  Item& into(Item& item) const {
    item.set("steps", steps);
    for (const db::Decision d :
         {db::Decision::kCaptured, db::Decision::kHeld, db::Decision::kSkipped,
          db::Decision::kMissed, db::Decision::kFailed})
      item.set(db::name(d), of[static_cast<int>(d)]);
    return item.set("partial", partial);
  }
};

void list(Context& context) {
  const db::ArchiveReader reader(context.archive());
  for (const db::RunRow& run : reader.runs()) {
    Item item;
    item.set("run_id", run.id.c_str())
        .set("specimen", run.specimen.c_str())
        .set("state", run.state.c_str())
        .set("t0_utc_ns", run.t0_utc)
        .set("interval_ns", run.interval)
        .set("duration_ns", run.duration);
    Counts(reader.steps(run.id)).into(item);
    context.out.add(std::move(item));
  }
}

Item runItem(const db::ArchiveReader& reader, const db::RunRow& run) {
  Item item;
  item.set("run_id", run.id.c_str())
      .set("specimen", run.specimen.c_str())
      .set("state", run.state.c_str())
      .set("t0_utc_ns", run.t0_utc)
      .set("interval_ns", run.interval)
      .set("duration_ns", run.duration)
      .set("seed", static_cast<std::int64_t>(run.seed))
      .set("plan_sha256", run.plan_sha256.c_str());
  Counts(reader.steps(run.id)).into(item);
  if (const auto frame = reader.newestFrame(run.id)) item.set("newest_frame_utc_ns", frame->utc);
  std::vector<std::string> products, events;
  for (const db::ProductRow& product : reader.products())
    if (product.run_id == run.id) products.push_back(product.id);
  for (const db::EventRow& event : reader.events(run.id))
    events.push_back(formatUtc(event.utc) + " " + event.kind + " " + event.detail);
  std::string lines;
  for (const std::string& event : events) lines += "\n  " + event;
  item.set("products", Value{products});
  item.set("events", Value{events}, lines.empty() ? "-" : lines);
  item.set("plan_toml", Value{run.plan_toml}, "\n" + run.plan_toml);
  item.hidden("rig_toml", Value{run.rig_toml});
  return item;
}

Item productItem(const db::ArchiveReader& reader, const db::ProductRow& product) {
  Item item;
  item.set("id", product.id.c_str())
      .set("kind", product.kind.c_str())
      .set("run_id", product.run_id.c_str())
      .set("path", workflow::pathOfProduct(reader.folder(), product).c_str())
      .set("command", product.command.c_str())
      .set("options_json", product.options_json.c_str())
      .set("seed", static_cast<std::int64_t>(product.seed))
      .set("version", product.version.c_str())
      .set("sha256", product.sha256.c_str())
      .set("created_utc_ns", product.created_utc)
      .set("metadata_json", product.metadata_json.c_str())
      .set("calibrations", Value{workflow::textsOf(workflow::calibrationsOf(reader, product))})
      .set("calibrations_left",
           Value{workflow::Facts::parse(product.metadata_json).texts("calibrations_left")})
      .set("inputs", product.input_sha256s.size())
      .hidden("input_sha256s", Value{product.input_sha256s});
  return item;
}

void show(Context& context, const std::string& id) {
  const db::ArchiveReader reader(context.archive());
  context.out.asList();
  for (const db::ProductRow& product : reader.products())
    if (product.id == id) return context.out.add(productItem(reader, product));
  context.out.add(runItem(reader, reader.findRun(id)));
}

Item stepItem(const db::StepRow& step) {
  Item item;
  item.set("number", step.number ? Value{*step.number} : Value{})
      .set("due_utc_ns", step.due_utc)
      .set("decision", db::name(step.decision))
      .set("shots_captured", step.shots_captured)
      .set("shots_due", step.shots_due)
      .set("retries", step.retries)
      .set("held_ns", step.held)
      .set("spread_ns", step.spread)
      .set("reason", step.reason.c_str());
  return item;
}

Item frameItem(const db::ArchiveReader& reader, const db::FrameRow& frame) {
  Item item;
  item.hidden("shot_id", Value{std::int64_t{frame.shot_id}})
      .hidden("file_index", Value{std::int64_t{frame.file_index}})
      .set("utc_ns", frame.utc)
      .set("ext", frame.ext.c_str())
      .bytes("bytes", static_cast<std::uint64_t>(frame.bytes))
      .set("width_px", frame.size.width)
      .set("height_px", frame.size.height)
      .hidden("sha256", Value{frame.sha256.hex()})
      .set("acked_utc_ns", frame.acked_utc)
      .set("path", reader.pathOf(frame).c_str());
  return item;
}

struct Query {
  std::string run = "latest", decision;
  std::int64_t step = -1;
  bool newest = false;
  std::optional<UtcTime> from, to;
};

void query(Context& context, const Query& query) {
  const db::ArchiveReader reader(context.archive());
  const std::string run = reader.findRun(query.run).id;
  if (query.newest) {
    if (const auto frame = reader.newestFrame(run)) context.out.add(frameItem(reader, *frame));
  } else if (query.step >= 0) {
    const auto step = reader.step(run, query.step);
    if (!step)
      throw AppError(Exit::kUsage, run + " has no step " + std::to_string(query.step) + " yet");
    for (const db::FrameRow& frame : reader.framesOfStep(step->id))
      context.out.add(frameItem(reader, frame));
  } else if (query.from || query.to) {
    for (const db::FrameRow& frame : reader.framesBetween(run, query.from.value_or(UtcTime::min()),
                                                          query.to.value_or(UtcTime::max())))
      context.out.add(frameItem(reader, frame));
  } else {
    std::optional<db::Decision> decision;
    if (!query.decision.empty()) decision = db::parseDecision(query.decision);
    for (const db::StepRow& step : reader.steps(run, decision)) context.out.add(stepItem(step));
  }
}

}  // namespace

void addArchiveReading(Verb archive) {
  archive.verb("list", "The runs there are", "patina archive list --archive ivy",
               [](Context& context) { list(context); });
  auto id = std::make_shared<std::string>();
  archive
      .verb("show", "All about a run or a product", "patina archive show latest --archive ivy",
            [id](Context& context) { show(context, *id); })
      .required("ID", *id, "A run (id, prefix of one, latest) or the id of a product");
  auto q = std::make_shared<Query>();
  archive
      .verb("query", "Steps of a run, or its frames",
            "patina archive query --run latest --decision missed --archive ivy",
            [q](Context& context) { query(context, *q); })
      .option("--run", q->run, "RUN", "A run's id, a prefix of one, or latest (the default)")
      .option("--decision", q->decision, "NAME",
              "Steps that were captured, held, skipped, missed or failed")
      .take(
          "--step", "N", [q](const std::string& text) { q->step = std::stoll(text); },
          "Frames of one step")
      .flag("--newest", q->newest, "The newest frame")
      .option("--from", q->from, parseUtc, "UTC", "Frames from this time on")
      .option("--to", q->to, parseUtc, "UTC", "Frames before this time");
}

}  // namespace patina::app
