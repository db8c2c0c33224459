// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/ttf_product.h"

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {
namespace {

std::string rectText(const RectPx& r) {
  return std::to_string(r.x) + "," + std::to_string(r.y) + "," + std::to_string(r.width) + "," +
         std::to_string(r.height);
}

Facts optionsOf(const TtfRequest& request, const FramesReport& frames, SizePx size) {
  Facts options;
  options.text("camera", frames.camera);
  options.text("light", frames.light);
  options.count("exposure", frames.exposure);
  options.set("display_referred", frames.display_referred);
  options.count("every", request.selection.every);
  options.set("partial", request.selection.partial);
  options.set("light_gain", request.correction.light_gain);
  if (request.lamps.any())
    options.set("ambient", request.lamps.ambient).set("lamps_apart", request.lamps.apart);
  options.set("masters", frames.masters);
  if (request.colour) options.text("colour", nameOf(*request.colour));
  if (request.registration) {
    options.text("register", name(request.registration->model));
    options.set("markers", request.registration->markers);
    options.set("deform", request.registration->deform);
    std::vector<std::string> fiducials;
    for (const RectPx& r : request.registration->fiducials) fiducials.push_back(rectText(r));
    options.set("fiducials", fiducials);
  }
  options.number("scale", request.build.scale);
  const RectPx region = request.build.region.value_or(RectPx{0, 0, size.width, size.height});
  options.text("region", rectText(region));
  return options;
}

// Mean of a quantity over the run; nothing when no sensor measured it.
std::optional<double> meanReading(const db::ArchiveReader& reader, const std::string& run_id,
                                  const std::string& quantity) {
  double sum = 0;
  std::int64_t count = 0;
  for (const db::ReadingRow& reading : reader.readings(run_id))
    if (reading.quantity == quantity && reading.quality == "ok") {
      sum += reading.value;
      ++count;
    }
  return count > 0 ? std::optional<double>(sum / static_cast<double>(count)) : std::nullopt;
}

Facts metadataOf(const TtfRequest& request, const db::ArchiveReader& reader, const db::RunRow& run,
                 const FramesReport& frames, SizePx size, double span_s) {
  Facts facts;
  facts.text("specimen", run.specimen);
  facts.text("process", request.process);
  facts.text("licence", request.licence);
  if (!request.after.empty()) facts.text("after", request.after);
  facts.count("frames", frames.frames);
  facts.count("interval_ns", run.interval.count() * request.selection.every);
  facts.count("duration_ns", fromSeconds(span_s).count());
  facts.text("camera", frames.camera);
  facts.text("light", frames.light);
  facts.count("exposure", frames.exposure);
  facts.count("width_px", size.width);
  facts.count("height_px", size.height);
  facts.count("t0_utc_ns", toNs(run.t0_utc));
  facts.number("mm_per_texel", request.build.mm_per_texel);
  if (const auto humidity = meanReading(reader, run.id, "humidity"))
    facts.number("humidity_percent", *humidity);
  if (const auto degrees = meanReading(reader, run.id, "temperature"))
    facts.number("temperature_c", *degrees);
  return facts;
}

// The pose of every frame, as a product of its own that the texture names as an input.
void keepRegistration(const std::filesystem::path& archive, const db::ArchiveReader& reader,
                      const std::string& run_id, const TtfRequest& request, UtcTime now,
                      Making& making, TtfOutcome& outcome) {
  const ProductFile file = placeProduct(archive, freeProductId(reader, "registration", run_id),
                                        "registration.jsonl", {});
  writeFileAtomically(file.path, registrationLines(outcome.registration, *request.registration));
  const db::ProductRow row = recordProduct(archive, file, "registration", run_id, making, {}, now);
  outcome.registration_id = row.id;
  making.input_sha256s.push_back(row.sha256);
}

}  // namespace

TtfOutcome makeTtf(const std::filesystem::path& archive, const TtfRequest& request, UtcTime now,
                   Progress& progress) {
  const db::ArchiveReader reader(archive);
  const db::RunRow run = reader.findRun(request.run);
  Correction of_frames = request.correction;
  if (request.lamps.any()) of_frames.light_gain = false;  // follows when ambient light is gone
  ArchiveFrames frames(reader, run.id, request.selection, of_frames);
  ttf::FrameSource* source = &frames;
  std::optional<LampFrames> lamps;
  if (request.lamps.any())
    source = &lamps.emplace(reader, run.id, frames, request.selection, request.correction,
                            request.lamps);
  const SizePx whole = frames.report().size;
  if (const auto& r = request.build.region;
      r && (r->x + r->width > whole.width || r->y + r->height > whole.height))
    throw WorkflowError(Exit::kUsage, "the region does not lie within the frames of " +
                                          std::to_string(whole.width) + "x" +
                                          std::to_string(whole.height) + " pixels");
  std::optional<RegisteredFrames> registered;
  if (request.registration)
    source = &registered.emplace(*source, *request.registration, std::nullopt, progress);
  std::optional<ColourFrames> coloured;
  if (request.colour)
    source = &coloured.emplace(*source, reader, run.id, frames.report(), *request.colour,
                               request.correction.stale);
  TtfOutcome outcome;
  outcome.size = request.build.region
                     ? SizePx{request.build.region->width, request.build.region->height}
                     : whole;
  Making making{request.command, optionsOf(request, frames.report(), whole), request.seed,
                request.version, frames.report().input_sha256s};
  if (lamps) {
    const std::vector<std::string>& others = lamps->report().input_sha256s;
    making.input_sha256s.insert(making.input_sha256s.end(), others.begin(), others.end());
  }
  if (coloured) {
    const std::vector<std::string>& charts = coloured->report().input_sha256s;
    making.options.set("colour_calibrations", charts);
    making.input_sha256s.insert(making.input_sha256s.end(), charts.begin(), charts.end());
  }
  const ProductFile file =
      placeProduct(archive, freeProductId(reader, "ttf", run.id), "ttf.h5", request.out);
  ttf::TtfInfo about;
  about.scale = request.build.scale;
  about.mm_per_texel = request.build.mm_per_texel;
  about.t0_utc = run.t0_utc;
  about.provenance_json = making.facts().json();
  outcome.build = ttf::buildTtf(*source, request.build, about, file.path, progress);
  if (coloured) outcome.colour = coloured->report();
  std::vector<db::FrameCalibrationRow> bindings = frames.bindings();
  bindings.insert(bindings.end(), outcome.colour.bindings.begin(), outcome.colour.bindings.end());
  if (!bindings.empty()) db::ProductWriter::bind(archive, bindings);
  outcome.frames = frames.report();
  if (lamps) {
    outcome.lamps = lamps->report();
    outcome.frames.gain_min = outcome.lamps.gain_min;
    outcome.frames.gain_max = outcome.lamps.gain_max;
  }
  if (registered) {
    outcome.registration = registered->report();
    keepRegistration(archive, reader, run.id, request, now, making, outcome);
  }
  outcome.path = file.path;
  const ttf::TtfReader built(file.path);
  const std::vector<double>& times = built.info().time_s;
  const double span = times.empty() ? 0 : times.back() - times.front();
  Facts metadata = metadataOf(request, reader, run, outcome.frames, outcome.size, span);
  metadata.count("frames", outcome.build.frames);
  if (registered) {
    metadata.text("registration", outcome.registration_id);
    metadata.count("refused_frames", outcome.registration.refused);
    metadata.count("pose_epochs", static_cast<std::int64_t>(outcome.registration.epochs.size()));
  }
  outcome.product = recordProduct(archive, file, "ttf", run.id, making, metadata, now);
  return outcome;
}

}  // namespace patina::workflow
