// SPDX-License-Identifier: GPL-3.0-or-later
// patina archive export RUN OUT: the frames of a run as plain files, for other programs.
#include "capture/app/context.h"
#include "capture/app/verbs/archive_verbs.h"
#include "capture/workflow/export_frames.h"

namespace patina::app {
namespace {

struct Options {
  std::string preset = "utc", run, out;
  bool link = false, xmp = false;
};

void exportRun(Context& context, const Options& options) {
  if (options.preset != "utc")
    throw AppError(Exit::kUsage,
                   "there is no preset '" + options.preset + "'; this build has: utc");
  const db::ArchiveReader reader(context.archive());
  const workflow::ExportReport report =
      workflow::exportFrames(reader, reader.findRun(options.run).id, options.out,
                             {options.link, options.xmp}, context.progress);
  Item item;
  item.set("run_id", report.run_id.c_str())
      .set("path", options.out.c_str())
      .set("frames", report.frames)
      .set("written", report.written)
      .set("linked", report.linked)
      .bytes("bytes_written", report.bytes_written);
  if (!report.problems.empty()) {
    std::string lines;
    for (const std::string& line : report.problems) lines += "\n  " + line;
    item.set("problems", Value{report.problems}, lines);
    context.exit_code = static_cast<int>(Exit::kBadData);
  }
  context.out.asList();
  context.out.add(std::move(item));
}

}  // namespace

void addArchiveExport(Verb archive) {
  auto o = std::make_shared<Options>();
  archive
      .verb("export", "Frames as files named by time, step, camera and light, with a manifest",
            "patina archive export --preset utc latest out/ --archive ivy",
            [o](Context& context) { exportRun(context, *o); })
      .required("RUN", o->run, "A run's id, a prefix of one, or latest")
      .required("OUT", o->out, "A new folder, or one of an earlier export of this run: it goes on")
      .option("--preset", o->preset, "NAME", "utc: one folder, names that sort by time")
      .flag("--xmp", o->xmp, "Also sidecars name.ext.xmp, for programs that read them")
      .flag("--link", o->link,
            "Hard links instead of copies where possible; both names become read-only");
}

}  // namespace patina::app
