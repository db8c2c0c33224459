// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/ttf_again.h"

#include <cstdio>

#include "capture/workflow/failure.h"

namespace patina::workflow {
namespace {

// Reads what addOptions() and optionsOf() wrote.
class Options {
 public:
  explicit Options(const db::ProductRow& texture)
      : id_(texture.id), facts_(Facts::parse(texture.options_json)) {}

  std::string text(const std::string& key) const {
    if (const auto value = facts_.text(key)) return *value;
    missing(key);
  }
  double number(const std::string& key) const {
    if (const auto value = facts_.number(key)) return *value;
    missing(key);
  }
  int count(const std::string& key) const { return static_cast<int>(number(key)); }
  RectPx rect(const std::string& of) const {
    RectPx r;
    if (std::sscanf(of.c_str(), "%d,%d,%d,%d", &r.x, &r.y, &r.width, &r.height) != 4) missing(of);
    return r;
  }
  const Facts& facts() const { return facts_; }

 private:
  [[noreturn]] void missing(const std::string& key) const {
    throw WorkflowError(Exit::kBadData, id_ + " does not say its " + key +
                                            ": it was made by an older Patina; give `patina ttf "
                                            "build` its options anew");
  }
  const std::string id_;
  const Facts facts_;
};

FieldUse fieldUseNamed(const std::string& name) {
  return name == "asked"  ? FieldUse::kAsked
         : name == "none" ? FieldUse::kNone
                          : FieldUse::kWhereItFits;
}

calibration::ColourSpace spaceNamed(const std::string& name) {
  return name == nameOf(calibration::ColourSpace::kXyz) ? calibration::ColourSpace::kXyz
                                                        : calibration::ColourSpace::kLinearSrgb;
}

RegistrationRequest registrationOf(const Options& options) {
  RegistrationRequest wanted;
  wanted.model = calibration::parseMotionModel(options.text("register"));
  wanted.markers = options.facts().flag("markers");
  wanted.deform = options.facts().flag("deform");
  for (const std::string& rect : options.facts().texts("fiducials"))
    wanted.fiducials.push_back(options.rect(rect));
  return wanted;
}

RectifyRequest rectifyOf(const Options& options) {
  RectifyRequest wanted;
  wanted.region = {options.number("left_mm"), options.number("bottom_mm"),
                   options.number("width_mm"), options.number("height_mm")};
  wanted.texels_per_mm = 1 / options.number("mm_per_texel");
  return wanted;
}

}  // namespace

TtfRequest requestOf(const db::ProductRow& texture) {
  const Options options(texture);
  const Facts& facts = options.facts();
  TtfRequest request;
  request.run = texture.run_id;
  request.selection.camera = options.text("camera");
  request.selection.light = options.text("light");
  request.selection.every = options.count("every");
  request.selection.file_index = options.count("file");
  request.selection.partial = facts.flag("partial");
  request.selection.merged = facts.number("hdr").has_value();
  if (!request.selection.merged) request.selection.exposure = options.count("exposure");
  request.correction = {facts.flag("light_gain"), facts.flag("corrected"), facts.flag("stale")};
  request.lamps = {facts.flag("ambient"), facts.flag("lamps_apart")};
  request.field = fieldUseNamed(options.text("field_use"));
  request.albedo = facts.flag("albedo");
  if (const auto space = facts.text("colour")) request.colour = spaceNamed(*space);
  if (facts.text("register")) request.registration = registrationOf(options);
  if (facts.number("left_mm")) request.rectify = rectifyOf(options);
  request.build.scale = options.number("scale");
  request.build.compress = facts.flag("compress");
  request.build.region = options.rect(options.text("region"));
  const Facts metadata = Facts::parse(texture.metadata_json);
  if (!request.rectify) request.build.mm_per_texel = metadata.number("mm_per_texel").value_or(0);
  request.process = metadata.text("process").value_or("");
  request.licence = metadata.text("licence").value_or("");
  request.command = texture.command;
  request.seed = texture.seed;
  return request;
}

}  // namespace patina::workflow
