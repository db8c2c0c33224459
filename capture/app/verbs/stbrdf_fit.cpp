// SPDX-License-Identifier: GPL-3.0-or-later
// patina stbrdf fit: from maps at several times to polynomials, or to STAF's factors.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "capture/app/verbs/stbrdf_verbs.h"
#include "processing/image/picture_file.h"
#include "processing/stbrdf/degree_choice.h"
#include "processing/stbrdf/polynomial_fit.h"
#include "processing/stbrdf/staf_file.h"
#include "processing/stbrdf/stbrdf_file.h"

namespace patina::app {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> in, maps;
  std::string out, degree = "3", as = "polynomials", errors;
  bool bounded = false;
};

int degreeOf(const std::string& text) {
  char* end = nullptr;
  const long degree = std::strtol(text.c_str(), &end, 10);
  if (end == text.c_str() || *end != '\0' || degree < 0 || degree > stbrdf::kDegreeMax)
    throw AppError(Exit::kUsage, "--degree is '" + text + "'; allowed: 0 to " +
                                     std::to_string(stbrdf::kDegreeMax) + ", or auto");
  return static_cast<int>(degree);
}

// By cross-validation over the maps of the BRDF; says what each degree would cost.
int choose(Context& context, const std::vector<stbrdf::TimeSamples>& samples) {
  const stbrdf::DegreeChoice choice = stbrdf::chooseDegree(samples, {});
  for (const stbrdf::DegreeRow& row : choice.rows)
    context.verbose("degree " + std::to_string(row.degree) + ": RMS " +
                    std::to_string(row.fit_rms) + ", of steps left out " +
                    std::to_string(row.left_out_rms) +
                    (choice.overfits(row.degree) ? ", over-fitted" : ""));
  context.out.say("degree " + std::to_string(choice.degree) + " by cross-validation");
  return choice.degree;
}

void warnOfOverfitting(const Context& context, const std::vector<stbrdf::TimeSamples>& samples,
                       int degree) {
  if (samples[0].times.size() < 3) return;
  const stbrdf::DegreeChoice choice = stbrdf::chooseDegree(samples, {});
  if (choice.overfits(degree))
    context.warn("degree " + std::to_string(degree) + " over-fits " + samples[0].name +
                 ": degree " + std::to_string(choice.degree) +
                 " predicts steps that were left out better");
}

Item row(const std::string& name, const std::vector<double>& rms, Nanoseconds time) {
  double sum = 0;
  for (const double v : rms) sum += v * v;
  return std::move(Item()
                       .set("map", name.c_str())
                       .set("channels", rms.size())
                       .set("rms", Value{std::sqrt(sum / static_cast<double>(rms.size()))})
                       .hidden("fit_ns", Value{static_cast<std::int64_t>(time.count())}));
}

void fitPolynomials(Context& context, const Options& options, const stbrdf::SampleSet& input) {
  const std::vector<std::string> names = mapsToFit(input, options.maps);
  stbrdf::StbrdfSet set;
  set.model = input.model;
  set.roughness = input.roughness;
  set.facts = input.facts;
  set.facts.set("sampled_times", input.times).text("made_by", "patina " PATINA_VERSION);
  std::vector<stbrdf::TimeSamples> kept;
  const bool automatic = options.degree == "auto";
  if (automatic) {
    for (const std::string& name : names)
      kept.push_back(stbrdf::readSamples(input, name, context.progress));
    set.degree = choose(context, kept);
  } else {
    set.degree = degreeOf(options.degree);
  }
  set.basis = stbrdf::basisOf(set.degree);
  std::vector<Image<float>> errors;
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::vector<stbrdf::TimeSamples> one;
    if (automatic)
      one.push_back(std::move(kept[i]));
    else
      one.push_back(stbrdf::readSamples(input, names[i], context.progress));
    const MonoTime before = context.clock.mono();
    stbrdf::FittedMap fitted =
        stbrdf::fitMap(one[0], {.degree = set.degree, .weights = {}, .bounded = options.bounded},
                       context.progress);
    Item item = row(names[i], fitted.rms, context.clock.mono() - before);
    if (!automatic) warnOfOverfitting(context, one, set.degree);
    const auto [least, most] =
        std::minmax_element(fitted.error.texels().begin(), fitted.error.texels().end());
    (void)least;
    item.set("rms_worst_texel", Value{static_cast<double>(*most)}).set("degree", set.degree);
    if (options.bounded)
      item.set("bounded_share", Value{static_cast<double>(fitted.bounded_series) /
                                      static_cast<double>(fitted.error.texels().size())});
    context.out.add(std::move(item));
    set.maps.push_back(std::move(fitted.map));
    errors.push_back(std::move(fitted.error));
  }
  stbrdf::writeStbrdfSet(options.out, set, context.progress);
  if (options.errors.empty()) return;
  fs::create_directories(options.errors);
  for (std::size_t i = 0; i < errors.size(); ++i)
    writeExr(fs::path(options.errors) / (names[i] + ".exr"), errors[i].view());
}

void fitFactors(Context& context, const Options& options, const stbrdf::SampleSet& input) {
  stbrdf::StafSet set;
  set.model = input.model;
  set.roughness = input.roughness;
  for (const std::string name : {"Diffuse", "Specular", "Roughness"}) {
    const stbrdf::TimeSamples samples = stbrdf::readSamples(input, name, context.progress);
    const MonoTime before = context.clock.mono();
    stbrdf::StafFit fitted = stbrdf::fitStaf(samples, {}, context.progress);
    context.out.add(row(name, fitted.rms, context.clock.mono() - before));
    set.maps.push_back(std::move(fitted.map));
  }
  stbrdf::writeStafSet(options.out, set);
}

void fit(Context& context, const Options& options) {
  if (options.in.empty())
    throw AppError(Exit::kUsage, "name the maps to fit: a folder with t0000/");
  if (options.as != "polynomials" && options.as != "staf")
    throw AppError(Exit::kUsage, "--as is '" + options.as + "'; allowed: polynomials, staf");
  if (options.degree != "auto") degreeOf(options.degree);
  refuseThatIsThere({options.out});
  const stbrdf::SampleSet input = openSamples(context, options.in);
  if (options.as == "staf")
    fitFactors(context, options, input);
  else
    fitPolynomials(context, options, input);
}

}  // namespace

void addStbrdfFitVerb(Verb stbrdf) {
  auto o = std::make_shared<Options>();
  stbrdf
      .verb("fit", "From maps at several times to a polynomial in every texel",
            "patina stbrdf fit rust-steps --degree 4 --out rust",
            [o](Context& context) { fit(context, *o); })
      .list("IN", o->in,
            "A folder of steps (t0000/Diffuse.exr) or of sequences (Diffuse.0000.exr), or the "
            "BRDF sets of several times")
      .option("--degree", o->degree, "D|auto", "0 to 12, or by cross-validation (default: 3)")
      .flag("--bounded", o->bounded, "Keep every polynomial within its map's range")
      .option("--map", o->maps, "NAME", "Only this map; may be repeated")
      .option("--errors", o->errors, "FOLDER", "Write a map of RMS errors for each map")
      .option("--as", o->as, "polynomials|staf", "What to fit (default: polynomials)")
      .option("--out", o->out, "SET", "The folder to write")
      .demand("--out");
}

}  // namespace patina::app
