// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/frame_options.h"

#include "capture/app/context.h"
#include "capture/workflow/ttf_database.h"
#include "db/archive.h"

namespace patina::app {

void addFrameOptions(Verb& verb, FrameOptions& options) {
  workflow::FrameSelection& selection = options.selection;
  verb.option("--camera", selection.camera, "ID", "Where a run has several cameras")
      .option("--light", selection.light, "STATE", "Where it has several light states: key+fill")
      .option("--exposure", selection.exposure, parseExposureNumber, "N",
              "Where it has several exposures: 0 is the first")
      .option("--every", selection.every, 1, 1'000'000, "Every n-th of the frames there are")
      .option("--file", selection.file_index, 0, 9, "Of RAW+JPEG: 0 is the raw file")
      .flag("--partial", selection.partial, "Also frames of steps that are not whole")
      .flag("--uncorrected", options.uncorrected, "No dark, no flat, no light gains")
      .flag("--stale-calibration", options.correction.stale,
            "Also a dark or flat that is out of tolerance");
}

int parseExposureNumber(const std::string& text) {
  int index = -1;
  if (std::sscanf(text.c_str(), "%d", &index) != 1 || index < 0)
    throw AppError(Exit::kUsage, "'" + text + "' is no exposure's number (0, 1, ...)");
  return index;
}

calibration::RegionMm parseRegionMm(const std::string& text) {
  calibration::RegionMm r;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%lf,%lf,%lf,%lf%c", &r.left, &r.bottom, &r.width, &r.height,
                  &rest) != 4)
    throw AppError(Exit::kUsage, "'" + text + "' is no region: LEFT,BOTTOM,WIDTH,HEIGHT in mm");
  return r;
}

workflow::Correction correctionOf(const FrameOptions& options) {
  workflow::Correction correction = options.correction;
  if (options.uncorrected) correction.light_gain = correction.masters = false;
  return correction;
}

workflow::Sequence openSequence(const Context& context, const std::string& in,
                                const FrameOptions& options) {
  if (std::filesystem::is_regular_file(in)) {
    if (options.selection.every == 1) return workflow::sequenceOfTtf(in);
    workflow::Sequence sequence = workflow::sequenceOfTtf(in);
    const int every = options.selection.every;
    sequence.frames = (sequence.frames + every - 1) / every;
    sequence.open = [open = sequence.open, every](int n) { return open(n * every); };
    return sequence;
  }
  if (context.options.archive.empty())
    throw AppError(Exit::kUsage,
                   "there is no file " + in + "; if it is a run, give --archive DIR too");
  auto reader = std::make_shared<const db::ArchiveReader>(context.archive());
  for (const workflow::TtfEntry& entry : workflow::listTtfs(*reader))
    if (entry.id == in) return workflow::sequenceOfTtf(entry.path);
  return workflow::sequenceOfRun(reader, reader->findRun(in).id, options.selection,
                                 correctionOf(options));
}

}  // namespace patina::app
