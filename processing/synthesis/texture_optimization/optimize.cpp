// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/optimize.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "processing/image/random.h"
#include "processing/synthesis/texture_optimization/landmarks.h"
#include "processing/synthesis/texture_optimization/layout.h"
#include "processing/synthesis/texture_optimization/levels.h"

namespace patina::texture_optimization {
namespace {

// Where large parts of the sample go is decided on the coarse levels. Counted as on the finest one,
// uses are uneven there for good: the energy ends 5 % higher, the variance 3 % lower.
constexpr double kCoarseUniformity = 3;

// Parts of the sample are laid out on a level of 24 to 47 texels: below it patches show no more
// than half of the sample.
constexpr int kLayoutSidePx = 24;

// Most of the time goes into the two finest levels, most of the gain comes from their first rounds;
// not where they are the first that are searched.
constexpr int kQuickFinestRounds = 1, kQuickNextRounds = 2, kQuickCoarseRounds = 6;

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kUsage, what); }

std::string text(SizePx size) {
  return std::to_string(size.width) + "x" + std::to_string(size.height);
}

std::size_t texelsOf(SizePx size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

int levelsFor(SizePx source, const OptimizeOptions& options, const Constraints& constraints) {
  int levels = 1;
  while (true) {
    const SizePx next = halved(source, levels), result = halved(options.size, levels);
    if (std::min(next.width, next.height) < options.coarsest_px ||
        std::min(result.width, result.height) < options.field.patch ||
        !holdsPatch(allBeneath(constraints.usable, source, next), next, options.field.patch))
      return levels;
    ++levels;
  }
}

int roundsOn(int level, int first, const OptimizeOptions& options) {
  if (options.effort == Effort::kFull) return options.rounds;
  constexpr int kQuick[] = {kQuickFinestRounds, kQuickNextRounds, kQuickCoarseRounds};
  return std::min(options.rounds, kQuick[level == first ? 2 : std::min(level, 2)]);
}

void checkGuides(SizePx source, const OptimizeOptions& options, const Constraints& constraints) {
  const Image<float>&from = constraints.sample_guide, &to = constraints.result_guide;
  if (from.empty() && to.empty()) return;
  if (from.channels() != to.channels() || from.channels() > 24)
    refuse("the guides have " + std::to_string(from.channels()) + " channels for the sample and " +
           std::to_string(to.channels()) + " for the result; they have equally many, 1 to 24");
  if (from.size() != source)
    refuse("the sample's guide is " + text(from.size()) + " texels, the sample " + text(source));
  if (to.size() != options.size)
    refuse("the result's guide is " + text(to.size()) + " texels, the result " +
           text(options.size));
}

void checkMasks(SizePx source, const OptimizeOptions& options, const Constraints& constraints) {
  const std::vector<std::uint8_t>& usable = constraints.usable;
  if (!usable.empty() && usable.size() != texelsOf(source))
    refuse("the mask is not of the sample's size, " + text(source));
  if (!holdsPatch(usable, source, options.field.patch))
    refuse("the mask leaves no whole patch of " + std::to_string(options.field.patch) + " texels");
  if (!constraints.kept.empty() && constraints.kept.size() != texelsOf(options.size))
    refuse("what is kept is not of the result's size, " + text(options.size));
}

// A sample and what limits its result, on one level.
struct Level {
  SizePx source_size, target_size;
  std::vector<patch::CompactPart> parts;
  std::vector<std::uint8_t> usable;
  std::vector<std::int32_t> kept;
  patch::Labels labels = {};
};
Level levelOf(int level, const patch::CompactFeatures& compact, SizePx size,
              const Constraints& constraints) {
  const SizePx whole = compact.parts[0].texels.size(), source = halved(whole, level),
               target = halved(size, level);
  Level out{.source_size = source,
            .target_size = target,
            .parts = {},
            .usable = allBeneath(constraints.usable, whole, source),
            .kept = keptBeneath(constraints.kept, size, target, whole, source)};
  for (const patch::CompactPart& part : compact.parts)
    out.parts.push_back({averaged(part.texels, source), averaged(part.guide, target)});
  return out;
}

std::unique_ptr<patch::NearestField> fieldOf(const Level& level, double scale,
                                             const patch::FieldOptions& options,
                                             const patch::NearestField* coarse) {
  std::vector<patch::FurtherComponents> further;
  for (std::size_t i = 1; i < level.parts.size(); ++i)
    further.push_back({level.parts[i].texels.view(), level.parts[i].guide.view()});
  const patch::CompactPart& leading = level.parts[0];
  return std::make_unique<patch::NearestField>(leading.texels.view(), scale, level.target_size,
                                               options,
                                               patch::FieldLimits{.usable = level.usable,
                                                                  .kept = level.kept,
                                                                  .guide = leading.guide.view(),
                                                                  .further = further,
                                                                  .labels = &level.labels,
                                                                  .coarse = coarse});
}

// What is shown before the first search, and the level it stands on.
struct Shown {
  SizePx source_size, target_size;
  std::vector<std::int32_t> centres;
};
struct Beginning {
  int laid, level;  // that it stands on, and that is searched first
  bool joined;
  Shown shown;
  Landmarks landmarks = {};
  std::vector<patch::Labels::Copy> copies = {};  // which of them each of the texels shown may show
};

Beginning beginningOf(const patch::CompactFeatures& compact, const OptimizeOptions& options,
                      const Constraints& constraints, Progress& progress) {
  const SizePx whole = compact.parts[0].texels.size();
  const int coarsest = levelsFor(whole, options, constraints) - 1;
  int level = coarsest;
  const auto side = [&] {
    const SizePx size = halved(whole, level);
    return std::min(size.width, size.height);
  };
  while (level > 0 && side() < kLayoutSidePx) --level;
  // A guide says itself what goes where.
  if (!compact.guided()) {
    const Level there = levelOf(level, compact, options.size, constraints);
    Landmarks landmarks = landmarksOf(
        averaged(compact.parts[0].texels, halved(whole, std::max(level - 1, 0))).view());
    std::vector<std::int32_t> centres = laidOut(there.parts[0].texels.view(), there.target_size,
                                                {.wraps = options.field.wraps,
                                                 .usable = there.usable,
                                                 .kept = there.kept,
                                                 .landmarks = &landmarks},
                                                options.field.seed, progress);
    if (!centres.empty()) {
      std::vector<patch::Labels::Copy> copies =
          landmarksIn(centres, there.target_size, there.source_size, landmarks);
      return {.laid = level,
              .level = std::max(level - 1, 0),
              .joined = true,
              .shown = {there.source_size, there.target_size, std::move(centres)},
              .landmarks = std::move(landmarks),
              .copies = std::move(copies)};
    }
  }
  const SizePx source = halved(whole, coarsest), target = halved(options.size, coarsest);
  return {.laid = coarsest,
          .level = coarsest,
          .joined = false,
          .shown = {source, target, scattered(source, target, options.field)}};
}

}  // namespace

void OptimizeOptions::check(SizePx source) const {
  field.check();
  const std::string patch = std::to_string(field.patch);
  if (std::min(source.width, source.height) < field.patch)
    refuse("the sample is " + text(source) + " texels, smaller than the patch of " + patch);
  if (std::min(size.width, size.height) < field.patch)
    refuse("the result is " + text(size) + " texels, smaller than the patch of " + patch);
  if (size.width > 32768 || size.height > 32768) refuse("the result is larger than 32768 texels");
  if (rounds < 1 || rounds > 1000 || passes < 1 || passes > 1000)
    refuse("rounds and passes lie between 1 and 1000");
  if (coarsest_px < field.patch + 1) refuse("the coarsest level is no larger than the patch");
}

OptimizedField optimize(ImageView<const float> features, const OptimizeOptions& options,
                        const Constraints& constraints, Progress& progress) {
  const SizePx whole = features.size();
  options.check(whole);
  checkGuides(whole, options, constraints);
  checkMasks(whole, options, constraints);
  const patch::CompactFeatures compact = patch::compactFeatures(
      features, {constraints.sample_guide.view(), constraints.result_guide.view()},
      options.field.patch, progress);
  Beginning beginning = beginningOf(compact, options, constraints, progress);
  OptimizedField out{.size = options.size,
                     .source = whole,
                     .patch = options.field.patch,
                     .wraps = options.field.wraps,
                     .centres = {},
                     .kept = constraints.kept,
                     .gain = {},
                     .energy = {},
                     .landmarks = std::move(beginning.landmarks),
                     .levels = beginning.level + 1};
  // Work of a level grows with its texels.
  const auto work = [&](int level) {
    return std::max<std::int64_t>(1, (std::int64_t{1} << 20) >> (2 * level));
  };
  std::int64_t total = 0;
  const auto rounds = [&](int level) { return roundsOn(level, out.levels - 1, options); };
  for (int level = 0; level < out.levels; ++level) total += work(level) * rounds(level);
  progress.begin("optimising", total);

  std::unique_ptr<patch::NearestField> coarse;
  Shown& shown = beginning.shown;
  const SizePx laid = shown.target_size;
  for (int level = beginning.level; level >= 0; --level) {
    Level here = levelOf(level, compact, options.size, constraints);
    // Landmarks stay where the layout shows them: even use does not bring them back elsewhere.
    if (out.landmarks.count > 0)
      here.labels = labelsOf(out.landmarks, beginning.copies, laid, 1 << (beginning.laid - level),
                             here.source_size, here.target_size, options.field.wraps);
    patch::FieldOptions field_options = options.field;
    if (level > 0) field_options.uniformity *= kCoarseUniformity;
    field_options.seed = hashSeed(options.field.seed, static_cast<std::uint64_t>(level));
    const bool quick = options.effort == Effort::kQuick && level == 0;
    auto own = fieldOf(here, compact.scale, field_options, quick ? coarse.get() : nullptr);
    patch::NearestField& field = *own;
    field.start(refined(shown.centres, shown.source_size, shown.target_size, here.source_size,
                        here.target_size, options.field.patch / 2));
    if (beginning.joined && !compact.guided()) field.wakeSeams();
    beginning.joined = true;
    field.vote();
    for (int round = 0; round < rounds(level); ++round) {
      for (int pass = 0; pass < options.passes; ++pass) field.search(round * options.passes + pass);
      field.vote();
      progress.step(work(level));
    }
    out.energy = field.energy();
    shown = {here.source_size, here.target_size, field.centres()};
    coarse = std::move(own);
  }
  out.centres = std::move(shown.centres);
  const patch::CompactPart& leading = compact.parts[0];
  out.gain = contrastLost(leading.texels.view(),
                          leading.texels.channels() - leading.guide.channels(), out.votes());
  return out;
}

Image<float> shown(ImageView<const float> source, const OptimizedField& field) {
  PATINA_CHECK(source.size() == field.source);
  return sharpVote(source, field.votes(), field.gain);
}

}  // namespace patina::texture_optimization
