// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/ttf_product.h"

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"

namespace patina::workflow {
namespace {

Facts optionsOf(const TtfRequest& request, const FrameChain& chain) {
  Facts options;
  chain.addOptions(options);
  options.number("scale", request.build.scale).set("compress", request.build.compress);
  const SizePx size = chain.size();
  options.text("region",
               rectText(request.build.region.value_or(RectPx{0, 0, size.width, size.height})));
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
                 const TtfOutcome& outcome, double span_s) {
  const FramesReport& frames = outcome.frames;
  Facts facts;
  facts.text("specimen", run.specimen);
  facts.text("process", request.process);
  facts.text("licence", request.licence);
  if (!request.after.empty()) facts.text("after", request.after);
  facts.count("frames", outcome.build.frames);
  facts.count("interval_ns", run.interval.count() * request.selection.every);
  facts.count("duration_ns", fromSeconds(span_s).count());
  facts.text("camera", frames.camera);
  facts.text("light", frames.light);
  facts.count("exposure", frames.exposure);
  if (frames.exposures > 1)
    facts.count("exposures", frames.exposures)
        .count("saturated_samples", frames.saturated_samples)
        .number("disagreement", frames.disagreement_most);
  facts.count("width_px", outcome.size.width);
  facts.count("height_px", outcome.size.height);
  facts.count("t0_utc_ns", toNs(run.t0_utc));
  facts.number("mm_per_texel", outcome.mm_per_texel);
  if (const auto humidity = meanReading(reader, run.id, "humidity"))
    facts.number("humidity_percent", *humidity);
  if (const auto degrees = meanReading(reader, run.id, "temperature"))
    facts.number("temperature_c", *degrees);
  if (!outcome.calibrations_left.empty()) facts.set("calibrations_left", outcome.calibrations_left);
  if (outcome.registration_id.empty()) return facts;
  facts.text("registration", outcome.registration_id);
  facts.count("refused_frames", outcome.registration.refused);
  facts.count("pose_epochs", static_cast<std::int64_t>(outcome.registration.epochs.size()));
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
  FrameChain chain(reader, run, request, progress);
  const SizePx whole = chain.size();
  if (const auto& r = request.build.region;
      r && (r->x + r->width > whole.width || r->y + r->height > whole.height))
    throw WorkflowError(Exit::kUsage, "the region does not lie within the frames of " +
                                          std::to_string(whole.width) + "x" +
                                          std::to_string(whole.height) + " pixels");
  TtfOutcome outcome;
  outcome.size = request.build.region
                     ? SizePx{request.build.region->width, request.build.region->height}
                     : whole;
  outcome.mm_per_texel = chain.mmPerTexel() > 0 ? chain.mmPerTexel() : request.build.mm_per_texel;
  Making making{request.command, optionsOf(request, chain), request.seed, request.version, {}};
  chain.addInputs(making);
  const ProductFile file =
      placeProduct(archive, freeProductId(reader, "ttf", run.id), "ttf.h5", request.out);
  ttf::TtfInfo about;
  about.scale = request.build.scale;
  about.t0_utc = run.t0_utc;
  about.provenance_json = making.facts().json();
  ttf::BuildOptions build = request.build;
  build.mm_per_texel = outcome.mm_per_texel;
  outcome.build = ttf::buildTtf(chain.source(), build, about, file.path, progress);
  const std::vector<db::FrameCalibrationRow> bindings = chain.bindings();
  if (!bindings.empty()) db::ProductWriter::bind(archive, bindings);
  outcome.frames = chain.frames();
  outcome.calibrations = chain.calibrations();
  outcome.calibrations_left = chain.left();
  if (chain.registration()) {
    outcome.registration = *chain.registration();
    keepRegistration(archive, reader, run.id, request, now, making, outcome);
  }
  outcome.path = file.path;
  const ttf::TtfReader built(file.path);
  const std::vector<double>& times = built.info().time_s;
  const double span = times.empty() ? 0 : times.back() - times.front();
  outcome.product = recordProduct(archive, file, "ttf", run.id, making,
                                  metadataOf(request, reader, run, outcome, span), now);
  return outcome;
}

}  // namespace patina::workflow
