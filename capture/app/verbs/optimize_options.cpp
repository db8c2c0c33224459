// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/verbs/optimize_options.h"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

#include "processing/image/picture_file.h"
#include "processing/synthesis/texture_optimization/copies.h"

namespace patina::app {
namespace {

namespace optimization = texture_optimization;

[[noreturn]] void refuse(const std::string& what) { throw AppError(Exit::kUsage, what); }

// "SAMPLE.png:RESULT.png[:WEIGHT]"
void addGuideFrom(const std::string& text, optimization::Constraints& constraints) {
  std::vector<std::string> parts{""};
  for (const char c : text) {
    if (c == ':')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  double weight = 1;
  if (parts.size() == 3) {
    char* end = nullptr;
    weight = std::strtod(parts[2].c_str(), &end);
    if (parts[2].empty() || *end != '\0') parts.clear();
  }
  if (parts.size() < 2 || parts.size() > 3 || parts[0].empty() || parts[1].empty())
    refuse("--guide is '" + text + "'; two pictures and a weight, such as in.png:out.png:2");
  optimization::addGuide(constraints, readPicture(parts[0]).linear.view(),
                         readPicture(parts[1]).linear.view(), weight);
}

}  // namespace

void addOptimizeOptions(Verb& verb, OptimizeArguments& into) {
  verb.flag("--tile", into.optimize.field.wraps, "The result goes on at its other side")
      .option("--mask", into.mask, "MASK",
              "A picture of the sample's size: only where it is white the sample is shown")
      .option("--keep", into.keep, "MASK",
              "A picture of the result's size: where it is white the sample itself stays")
      .option("--keep-from", into.keep_from, "X,Y",
              "The sample's texel that what stays would show at 0,0 (default: 0,0)")
      .option("--guide", into.guides, "SAMPLE:RESULT[:WEIGHT]",
              "Two pictures that tell what shall look alike where; may be given again, 24 channels "
              "in all")
      .option("--gradient", into.gradient, 0.0, 1e6,
              "Weight of the place in the sample: what changes across it changes so across the "
              "result, against blotches like scales (default: 0)")
      .option("--uniformity", into.optimize.field.uniformity, 0.0, 1e6,
              "How much even use of the sample counts (default: 0.075)")
      .option("--patch", into.optimize.field.patch, 3, 7,
              "Side of a patch in texels: 3, 5 or 7 (default: 5)")
      .option("--search", into.search, "coherent|patchmatch",
              "How patches are found (default: coherent; PatchMatch is patented)")
      .option("--effort", into.effort, "quick|full",
              "Quick: fewer rounds, one on the finest level (default: full; of a picture: quick)")
      .option("--rounds", into.optimize.rounds, 1, 1000, "Of search and vote, a level (default: 8)")
      .option("--passes", into.optimize.passes, 1, 1000, "Of search, a round (default: 2)");
}

void settle(OptimizeArguments& arguments, const Context& context) {
  if (arguments.search != "coherent" && arguments.search != "patchmatch")
    refuse("--search is '" + arguments.search + "'; allowed: coherent, patchmatch");
  if (arguments.effort != "quick" && arguments.effort != "full")
    refuse("--effort is '" + arguments.effort + "'; allowed: quick, full");
  arguments.optimize.effort =
      arguments.effort == "quick" ? optimization::Effort::kQuick : optimization::Effort::kFull;
  arguments.optimize.field.seed = context.seed();
  arguments.optimize.field.search = arguments.search == "coherent" ? patch::SearchKind::kCoherent
                                                                   : patch::SearchKind::kPatchMatch;
}

optimization::Constraints constraintsOf(const OptimizeArguments& arguments, SizePx sample) {
  optimization::Constraints out;
  const auto sized = [](const std::string& file, SizePx size, const char* option) {
    Picture picture = readPicture(file);
    if (picture.linear.size() != size)
      refuse(std::string(option) + ": " + file + " is " + std::to_string(picture.linear.width()) +
             "x" + std::to_string(picture.linear.height()) + " pixels; it has to be " +
             std::to_string(size.width) + "x" + std::to_string(size.height));
    return std::move(picture.linear);
  };
  if (!arguments.mask.empty())
    out.usable = optimization::whiteOf(sized(arguments.mask, sample, "--mask").view());
  if (!arguments.keep.empty()) {
    int x = 0, y = 0;
    char rest = 0;
    if (std::sscanf(arguments.keep_from.c_str(), "%d,%d%c", &x, &y, &rest) != 2)
      refuse("--keep-from is '" + arguments.keep_from + "'; X,Y in pixels, such as 40,25");
    out.kept = optimization::keptFrom(
        sized(arguments.keep, arguments.optimize.size, "--keep").view(), sample, x, y);
  }
  for (const std::string& guide : arguments.guides) addGuideFrom(guide, out);
  if (arguments.gradient > 0)
    optimization::addGradientGuides(out, sample, arguments.optimize.size, arguments.gradient);
  return out;
}

void refuseBeyondMemory(std::int64_t bytes) {
  const std::int64_t pages = sysconf(_SC_PHYS_PAGES), page_bytes = sysconf(_SC_PAGESIZE),
                     machine_bytes = pages * page_bytes;
  constexpr double kGiB = 1 << 30;
  if (bytes <= machine_bytes) return;
  char text[200];
  std::snprintf(text, sizeof text,
                "--size would take about %.1f GiB of memory, this machine has %.1f: ask for less",
                static_cast<double>(bytes) / kGiB, static_cast<double>(machine_bytes) / kGiB);
  refuse(text);
}

void describe(const optimization::OptimizedField& field, double uniformity, Item& item) {
  item.set("levels", field.levels)
      .set("energy", Value{field.energy.patch + uniformity * field.energy.occupancy})
      .set("patch_energy", Value{field.energy.patch})
      .set("occupancy", Value{field.energy.occupancy});
  const optimization::CopiesApart copies = optimization::copiesApart(field);
  item.set("shown_again", Value{copies.shown_again})
      .set("copies_apart_least", Value{copies.least})
      .set("copies_apart_twentieth", Value{copies.twentieth})
      .set("copies_apart_median", Value{copies.median})
      .set("landmarks", field.landmarks.count)
      .set("landmarks_apart", Value{optimization::landmarksApart(field)});
}

}  // namespace patina::app
