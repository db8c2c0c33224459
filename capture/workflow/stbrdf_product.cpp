// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/stbrdf_product.h"

#include <algorithm>

#include "capture/workflow/failure.h"
#include "processing/stbrdf/polynomial_fit.h"
#include "processing/stbrdf/samples_file.h"
#include "processing/stbrdf/stbrdf_file.h"

namespace patina::workflow {

namespace fs = std::filesystem;

StbrdfOutcome fitStbrdf(const fs::path& archive, const StbrdfRequest& request, UtcTime now,
                        Progress& progress) {
  const db::ArchiveReader reader(archive);
  const db::ProductRow from = findProduct(reader, "brdf", request.brdf);
  const stbrdf::SampleSet input =
      stbrdf::openSamples({pathOfProduct(reader.folder(), from).parent_path()});
  StbrdfOutcome outcome;
  outcome.steps = static_cast<int>(input.times.size());
  outcome.degree = std::min(request.degree, outcome.steps - 1);
  stbrdf::StbrdfSet set;
  set.model = input.model;
  set.roughness = input.roughness;
  set.degree = outcome.degree;
  set.basis = stbrdf::basisOf(set.degree);
  set.facts.set("sampled_times", input.times).text("made_of", from.id);
  set.facts.text("made_of_sha256", from.sha256).text("made_by", "patina " + request.version);
  std::vector<double> rms;
  for (const char* name : {"Diffuse", "Specular", "Roughness", "Normal"}) {
    if (!input.maps.contains(name)) continue;
    const stbrdf::TimeSamples samples = stbrdf::readSamples(input, name, progress);
    stbrdf::FittedMap fitted =
        stbrdf::fitMap(samples, {.degree = set.degree, .weights = {}, .bounded = false}, progress);
    rms.push_back(*std::ranges::max_element(fitted.rms));
    set.maps.push_back(std::move(fitted.map));
  }
  set.facts.set("rms", rms);
  const std::string id = freeProductId(reader, "stbrdf", from.id.substr(from.id.find('-') + 1));
  outcome.set = db::ProductWriter::folderFor(archive, id);
  fs::create_directories(outcome.set.parent_path());
  fs::remove_all(outcome.set);  // no row names it
  stbrdf::writeStbrdfSet(outcome.set, set, progress);
  Making making{request.command, {}, 0, request.version, {from.sha256}};
  making.options.text("brdf", from.id).count("degree", set.degree);
  Facts metadata;
  metadata.text("after", request.after).count("steps", outcome.steps);
  const ProductFile file{id, outcome.set / "manifest.json", true};
  outcome.product = recordProduct(archive, file, "stbrdf", from.run_id, making, metadata, now);
  return outcome;
}

}  // namespace patina::workflow
