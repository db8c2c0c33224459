// SPDX-License-Identifier: GPL-3.0-or-later
// The JSON of a colour calibration, for colour_calibration.h.
#include <nlohmann/json.hpp>

#include "capture/workflow/colour_calibration.h"
#include "capture/workflow/failure.h"

namespace patina::workflow {
namespace {

using Json = nlohmann::ordered_json;
using calibration::kChartFields;
using calibration::Lab;

constexpr const char* kSchema = "patina.colour_calibration/1";

Json arrayOf(const Lab& lab) { return Json::array({lab.l, lab.a, lab.b}); }
Lab labOf(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json fieldsOf(const ColourCalibration& c) {
  Json fields = Json::array();
  for (int i = 0; i < kChartFields; ++i) {
    const calibration::FieldColours& field = c.report.fields[i];
    fields.push_back({{"name", calibration::fieldName(i)},
                      {"seen", c.seen[i]},
                      {"expected_lab", arrayOf(field.expected)},
                      {"before_lab", arrayOf(field.before)},
                      {"after_lab", arrayOf(field.after)},
                      {"delta_e_before", field.delta_e_before},
                      {"delta_e_after", field.delta_e_after}});
  }
  return fields;
}

Json jsonOf(const ColourCalibration& c) {
  const auto terms = static_cast<std::size_t>(termCount(c.model.kind));
  Json rows = Json::array(), kinds = Json::array(), corners = Json::array();
  for (std::size_t i = 0; i < 3; ++i)
    rows.push_back(std::vector<double>(
        c.model.xyz_from_terms.begin() + static_cast<std::ptrdiff_t>(i * terms),
        c.model.xyz_from_terms.begin() + static_cast<std::ptrdiff_t>((i + 1) * terms)));
  for (const calibration::KindError& kind : c.report.kinds)
    kinds.push_back({{"fit", nameOf(kind.kind)},
                     {"delta_e", kind.mean},
                     {"delta_e_left_out", kind.left_out_mean}});
  for (const calibration::PlacePx& place : c.corners)
    corners.push_back(Json::array({place.x, place.y}));
  const calibration::ChartVerdict& v = c.verdict;
  return {{"schema", kSchema},
          {"camera", c.camera},
          {"light", c.light},
          {"exposure_ns", c.exposure.count()},
          {"iso", c.iso},
          {"taken_utc_ns", toNs(c.taken_utc)},
          {"width_px", c.size.width},
          {"height_px", c.size.height},
          {"fit", nameOf(c.model.kind)},
          {"white", "D50"},
          {"xyz_from_terms", rows},
          {"delta_e",
           {{"before", c.report.mean_before},
            {"worst_before", c.report.worst_before},
            {"after", c.report.mean_after},
            {"median_after", c.report.median_after},
            {"worst_after", c.report.worst_after},
            {"worst_field", c.report.worst_field},
            {"left_out", c.report.left_out_mean},
            {"iterations", c.report.iterations}}},
          {"kinds", kinds},
          {"chart",
           {{"values", c.chart},
            {"corners_px", corners},
            {"turned", v.sense == calibration::ChartSense::kTurned},
            {"misfit", v.misfit},
            {"gradient", v.gradient},
            {"tilt_deg", v.tilt_deg},
            {"unevenness", v.unevenness},
            {"lone", v.lone},
            {"gamma", v.gamma},
            {"veil", v.veil}}},
          {"fields", fieldsOf(c)}};
}

void readModel(const Json& json, ColourCalibration& out) {
  const auto kind = calibration::fitNamed(json.at("fit").get<std::string>());
  if (!kind) throw WorkflowError(Exit::kBadData, "its fit is of a kind this Patina does not know");
  out.model.kind = *kind;
  for (const Json& row : json.at("xyz_from_terms"))
    for (const Json& value : row) out.model.xyz_from_terms.push_back(value.get<double>());
  if (out.model.xyz_from_terms.size() != static_cast<std::size_t>(3) * termCount(*kind))
    throw WorkflowError(Exit::kBadData, "its matrix has the wrong size");
}

void readChart(const Json& json, ColourCalibration& out) {
  out.chart = json.at("values").get<std::string>();
  for (std::size_t i = 0; i < out.corners.size(); ++i) {
    const Json& place = json.at("corners_px").at(i);
    out.corners[i] = {place.at(0).get<double>(), place.at(1).get<double>()};
  }
  calibration::ChartVerdict& v = out.verdict;
  v.sense = json.at("turned").get<bool>() ? calibration::ChartSense::kTurned
                                          : calibration::ChartSense::kUpright;
  v.misfit = json.at("misfit").get<double>();
  v.gradient = json.at("gradient").get<double>();
  v.tilt_deg = json.at("tilt_deg").get<double>();
  v.unevenness = json.at("unevenness").get<double>();
  v.lone = json.at("lone").get<double>();
  v.gamma = json.at("gamma").get<double>();
  v.veil = json.at("veil").get<double>();
}

void readReport(const Json& json, ColourCalibration& out) {
  const Json& delta_e = json.at("delta_e");
  calibration::ColourFitReport& report = out.report;
  report.mean_before = delta_e.at("before").get<double>();
  report.worst_before = delta_e.at("worst_before").get<double>();
  report.mean_after = delta_e.at("after").get<double>();
  report.median_after = delta_e.at("median_after").get<double>();
  report.worst_after = delta_e.at("worst_after").get<double>();
  report.worst_field = delta_e.at("worst_field").get<int>();
  if (report.worst_field < 0 || report.worst_field >= kChartFields)
    throw WorkflowError(Exit::kBadData, "its worst field is none of the chart");
  report.left_out_mean = delta_e.at("left_out").get<double>();
  report.iterations = delta_e.at("iterations").get<int>();
  for (const Json& kind : json.at("kinds"))
    if (const auto named = calibration::fitNamed(kind.at("fit").get<std::string>()))
      report.kinds.push_back(
          {*named, kind.at("delta_e").get<double>(), kind.at("delta_e_left_out").get<double>()});
  for (std::size_t i = 0; i < report.fields.size(); ++i) {
    const Json& field = json.at("fields").at(i);
    out.seen[i] = field.at("seen").get<calibration::Rgb>();
    report.fields[i] = {labOf(field.at("expected_lab")), labOf(field.at("before_lab")),
                        labOf(field.at("after_lab")), field.at("delta_e_before").get<double>(),
                        field.at("delta_e_after").get<double>()};
  }
}

}  // namespace

void writeColourCalibration(const std::filesystem::path& file,
                            const ColourCalibration& calibration) {
  writeFileAtomically(file, jsonOf(calibration).dump(1) + "\n");
}

ColourCalibration readColourCalibration(const std::filesystem::path& file) {
  constexpr std::uint64_t kBytesMax = 1 << 20;
  const Bytes bytes = readFile(file, kBytesMax);
  try {
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    const Json json = Json::parse(text, text + bytes.size());
    if (json.at("schema") != kSchema)
      throw WorkflowError(Exit::kBadData, "it is no " + std::string(kSchema));
    ColourCalibration out;
    out.camera = json.at("camera").get<std::string>();
    out.light = json.at("light").get<std::string>();
    out.exposure = Nanoseconds{json.at("exposure_ns").get<std::int64_t>()};
    out.iso = json.at("iso").get<double>();
    out.taken_utc = UtcTime{Nanoseconds{json.at("taken_utc_ns").get<std::int64_t>()}};
    out.size = {json.at("width_px").get<int>(), json.at("height_px").get<int>()};
    readModel(json, out);
    readChart(json.at("chart"), out);
    readReport(json, out);
    return out;
  } catch (const Json::exception& error) {
    throw WorkflowError(Exit::kBadData, file.string() + " is no colour calibration: " +
                                            error.what() + "; make it again from the chart");
  } catch (const WorkflowError& error) {
    throw WorkflowError(Exit::kBadData, file.string() + " cannot be used: " + error.what() +
                                            "; make it again from the chart");
  }
}

}  // namespace patina::workflow
