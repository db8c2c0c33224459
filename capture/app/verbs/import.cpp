// SPDX-License-Identifier: GPL-3.0-or-later
// patina import SOURCE: pictures that somebody else took become a run.
#include "capture/workflow/import.h"

#include "capture/app/context.h"
#include "capture/app/verbs/verbs.h"

namespace patina::app {
namespace {

struct Options {
  std::string source, times, specimen, process, licence, description, lights;
  Nanoseconds interval{};
  std::optional<UtcTime> start;
  bool again = false;
};

workflow::ListingOptions listingOf(const Options& options) {
  workflow::ListingOptions listing;
  listing.source = options.source;
  listing.interval = options.interval;
  listing.start_utc = options.start;
  if (!options.lights.empty()) listing.lights = options.lights;
  const bool interval = options.interval > Nanoseconds{};
  if (options.lights.empty() && interval == !options.times.empty())
    throw AppError(Exit::kUsage,
                   "when were these taken? Give one of --times names, --times exif and --interval "
                   "TIME (as --interval 10min)");
  if (options.times == "names")
    listing.times = workflow::TimesFrom::kNames;
  else if (options.times == "exif")
    listing.times = workflow::TimesFrom::kExif;
  else if (!options.times.empty())
    throw AppError(Exit::kUsage, "--times is names or exif, not '" + options.times + "'");
  return listing;
}

std::string sizeText(SizePx size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

void tell(Context& context, const workflow::ImportReport& report) {
  std::vector<std::string> rejected;
  for (const workflow::RejectedFile& file : report.rejected) {
    rejected.push_back(file.file);
    context.warn(file.file + " was set aside: " + file.why);
  }
  for (const std::string& file : report.without_time)
    context.warn(file + " was left out: nothing says when it was taken");
  if (report.sizes > 1)
    context.warn("the pictures have " + std::to_string(report.sizes) + " sizes, from " +
                 sizeText(report.smallest) + " to " + sizeText(report.largest) +
                 "; a texture is cut to the smallest about the centre");
  if (report.interval == Nanoseconds{} && report.captured > 1)
    context.warn("the times have no common interval, so no step counts as missed");
  context.out.asList();
  context.out.add(Item()
                      .set("run_id", report.run_id.c_str())
                      .set("steps", report.steps)
                      .set("captured", report.captured)
                      .set("missed", report.missed)
                      .set("failed", report.failed)
                      .set("frames", report.frames)
                      .set("interval_ns", report.interval)
                      .set("first_utc_ns", report.first_utc)
                      .set("last_utc_ns", report.last_utc)
                      .set("size_px", sizeText(report.smallest).c_str())
                      .set("sizes", report.sizes)
                      .set("quarantined", Value{rejected})
                      .hidden("without_time", Value{report.without_time})
                      .hidden("warnings", Value{static_cast<std::int64_t>(
                                              rejected.size() + report.without_time.size())})
                      .hidden("resumed", report.resumed));
}

void import(Context& context, const Options& options) {
  workflow::ImportOptions request;
  request.listing = listingOf(options);
  request.archive = context.archive();
  request.specimen = options.specimen;
  request.process = options.process;
  request.licence = options.licence;
  request.description = options.description;
  request.again = options.again;
  request.owner = context.command;
  tell(context, workflow::importPictures(
                    request, [&context] { return context.clock.utc(); }, context.progress));
}

}  // namespace

void addImportVerb(Verb root) {
  auto o = std::make_shared<Options>();
  root.verb("import", "Pictures, a GIF or a film become a run of the archive",
            "patina import pictures/ --specimen ivy --times names --archive ivy",
            [o](Context& context) { import(context, *o); })
      .required("SOURCE", o->source, "A folder of pictures, a GIF, a film, or one picture")
      .option("--specimen", o->specimen, "NAME", "What is seen")
      .demand("--specimen")
      .option("--interval", o->interval, parseDuration, "TIME", "One picture every so often: 10min")
      .option("--times", o->times, "names|exif", "Each picture's own time")
      .option("--start", o->start, parseUtc, "UTC",
              "When the first was taken (default: its file's time)")
      .option("--lights", o->lights, "FILE.lp", "One step, each picture under a light of its own")
      .option("--process", o->process, "NAME", "What happens to it: ripening, rusting ...")
      .option("--licence", o->licence, "NAME", "Who may use the pictures: CC-BY-4.0 ...")
      .option("--description", o->description, "TEXT", "One line about it")
      .flag("--again", o->again, "Import pictures that are in the archive already");
}

}  // namespace patina::app
