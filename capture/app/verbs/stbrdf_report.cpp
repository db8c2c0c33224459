// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf report: how well polynomials and STAF hold a material (Meister et al. 2021, section
// 7.4 and table 2).
#include <cmath>
#include <optional>

#include "capture/app/verbs/stbrdf_verbs.h"
#include "processing/stbrdf/polynomial_fit.h"
#include "processing/stbrdf/staf.h"

namespace patina::app {
namespace {

struct Options {
  std::vector<std::string> in;
  std::vector<int> degrees{3, 4, 5};
  bool without_staf = false;
};

// One way to hold a material; a value a channel, in the order Kd R G B, Ks, roughness.
struct Line {
  std::string name;
  std::vector<double> rms;
  Nanoseconds time{0};
  std::int64_t bytes = 0;
  std::optional<double> paper;  // the average of 26 measured materials
};

double rmsOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

// Colours apart for Diffuse, as in table 2; one figure for the other maps.
void append(Line& line, const std::string& map, const std::vector<double>& rms) {
  if (map == "Diffuse")
    line.rms.insert(line.rms.end(), rms.begin(), rms.end());
  else
    line.rms.push_back(rmsOf(rms));
}

std::optional<double> paperOf(int degree) {
  if (degree == 3) return 0.030;
  if (degree == 4) return 0.023;
  if (degree == 5) return 0.017;
  return std::nullopt;
}

std::vector<Line> measure(Context& context, const Options& options,
                          const stbrdf::SampleSet& input) {
  std::vector<Line> lines;
  lines.push_back({.name = "STAF", .rms = {}, .paper = 0.052});
  for (const int degree : options.degrees)
    lines.push_back({.name = "d = " + std::to_string(degree), .rms = {}, .paper = paperOf(degree)});
  for (const std::string map : {"Diffuse", "Specular", "Roughness"}) {
    const stbrdf::TimeSamples samples = stbrdf::readSamples(input, map, context.progress);
    const auto series = static_cast<std::int64_t>(samples.seriesCount());
    if (!options.without_staf) {
      const MonoTime before = context.clock.mono();
      const stbrdf::StafFit fitted = stbrdf::fitStaf(samples, {}, context.progress);
      lines[0].time += context.clock.mono() - before;
      lines[0].bytes += series * 4 * static_cast<std::int64_t>(sizeof(float));
      append(lines[0], map, fitted.rms);
    }
    for (std::size_t i = 0; i < options.degrees.size(); ++i) {
      const MonoTime before = context.clock.mono();
      const stbrdf::FittedMap fitted =
          stbrdf::fitMap(samples, {.degree = options.degrees[i], .weights = {}}, context.progress);
      lines[i + 1].time += context.clock.mono() - before;
      lines[i + 1].bytes +=
          series * (options.degrees[i] + 1) * static_cast<std::int64_t>(sizeof(float));
      append(lines[i + 1], map, fitted.rms);
    }
  }
  if (options.without_staf) lines.erase(lines.begin());
  return lines;
}

std::string shortly(double v) {
  char text[24];
  std::snprintf(text, sizeof text, "%.4f", v);
  return text;
}

void report(Context& context, const Options& options) {
  if (options.in.empty()) throw AppError(Exit::kUsage, "name the maps: a folder with t0000/");
  const stbrdf::SampleSet input = openSamples(context, options.in);
  for (const Line& line : measure(context, options, input)) {
    double mean = 0;
    for (const double v : line.rms) mean += v / static_cast<double>(line.rms.size());
    Item item;
    item.set("fit", line.name.c_str());
    const bool colour = line.rms.size() == 5;
    const std::vector<const char*> keys =
        colour ? std::vector<const char*>{"diffuse_r", "diffuse_g", "diffuse_b", "specular",
                                          "roughness"}
               : std::vector<const char*>{"diffuse", "specular", "roughness"};
    for (std::size_t i = 0; i < keys.size(); ++i)
      item.set(keys[i], Value{line.rms[i]}, shortly(line.rms[i]));
    item.set("overall", Value{mean}, shortly(mean));
    if (line.paper)
      item.set("paper_overall", Value{*line.paper}, shortly(*line.paper));
    else
      item.set("paper_overall", Value{}, "-");
    char seconds[24];
    std::snprintf(seconds, sizeof seconds, "%.3f s", toSeconds(line.time));
    item.set("fit_ns", Value{static_cast<std::int64_t>(line.time.count())}, seconds);
    item.bytes("bytes", static_cast<std::uint64_t>(line.bytes));
    context.out.add(std::move(item));
  }
}

}  // namespace

void addStbrdfReportVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  stbrdf
      .verb("report", "RMS errors of polynomials and STAF, times and memory",
            "patina stbrdf report rust-steps", [o](Context& context) { report(context, *o); })
      .list("IN", o->in, "What `stbrdf fit` takes")
      .take(
          "--degrees", "D,D,...",
          [o](const std::string& text) {
            o->degrees.clear();
            std::size_t at = 0;
            while (at <= text.size()) {
              const std::size_t comma = std::min(text.find(',', at), text.size());
              const std::string one = text.substr(at, comma - at);
              char* end = nullptr;
              const long degree = std::strtol(one.c_str(), &end, 10);
              if (one.empty() || *end != '\0' || degree < 0 || degree > stbrdf::kDegreeMax)
                throw AppError(Exit::kUsage, "'" + one + "' is no degree (0 to " +
                                                 std::to_string(stbrdf::kDegreeMax) + ")");
              o->degrees.push_back(static_cast<int>(degree));
              at = comma + 1;
            }
          },
          "Of the polynomials (default: 3,4,5)")
      .flag("--without-staf", o->without_staf, "Polynomials alone");
}

}  // namespace patina::app
