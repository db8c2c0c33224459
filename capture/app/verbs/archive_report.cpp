// SPDX-License-Identifier: GPL-3.0-or-later
// patina archive report RUN: what happened in a run, for a person to read.
#include <algorithm>

#include "capture/app/context.h"
#include "capture/app/verbs/archive_verbs.h"
#include "capture/workflow/run_report.h"
#include "processing/image/picture_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::string run = "latest", out;
};

// "contact-sheet.png" is the picture "contact sheet".
std::string titleOf(const fs::path& file) {
  std::string title = file.stem().string();
  std::replace_if(
      title.begin(), title.end(), [](char c) { return c == '-' || c == '_'; }, ' ');
  return title;
}

// Pictures and films that lie in the report's folder already; films first.
std::vector<workflow::ReportPicture> picturesIn(const fs::path& folder) {
  std::vector<workflow::ReportPicture> pictures;
  for (const char* ext : {".mp4", ".png"}) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder))
      if (entry.is_regular_file() && entry.path().extension() == ext)
        files.push_back(entry.path().filename());
    std::sort(files.begin(), files.end());
    for (const fs::path& file : files) pictures.push_back({titleOf(file), file.string()});
  }
  return pictures;
}

void report(Context& context, const Options& options) {
  const db::ArchiveReader reader(context.archive());
  const workflow::RunReport report = workflow::reportRun(reader, reader.findRun(options.run).id);
  Item item;
  item.set("run_id", report.run.id.c_str())
      .set("steps", report.steps_due)
      .set("captured", report.captured)
      .set("held", report.held)
      .set("skipped", report.skipped)
      .set("missed", report.missed)
      .set("failed", report.failed)
      .set("partial", report.partial)
      .set("captured_after_hold", report.captured_after_hold)
      .set("retried", report.retried)
      .set("manual", report.manual)
      .set("frames", report.frames)
      .bytes("bytes", static_cast<std::uint64_t>(report.bytes));
  if (options.out.empty()) {
    context.out.say(workflow::reportMarkdown(report, {}));
  } else {
    const fs::path folder = options.out;
    fs::create_directories(folder);
    const auto pictures = picturesIn(folder);
    writeFileAtomically(folder / "report.md", workflow::reportMarkdown(report, pictures));
    writeFileAtomically(folder / "report.html", workflow::reportHtml(report, pictures));
    item.set("path", (folder / "report.html").c_str());
  }
  context.out.asList();
  context.out.add(std::move(item));
}

}  // namespace

void addArchiveReport(Verb archive) {
  auto o = std::make_shared<Options>();
  archive
      .verb("report", "What happened in a run: counts, reasons, light, events",
            "patina archive report latest --out report --archive banana",
            [o](Context& context) { report(context, *o); })
      .optional("RUN", o->run, "A run's id, a prefix of one, or latest")
      .option("--out", o->out, "FOLDER",
              "Writes report.md and report.html there, with the pictures and films it holds");
}

}  // namespace patina::app
