// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/registration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include "calibration/failure.h"
#include "calibration/registration/feature_start.h"
#include "calibration/registration/mosaic_refinement.h"
#include "calibration/registration/refinement.h"
#include "calibration/registration/spectral_refinement.h"

namespace patina::calibration {
namespace {

constexpr double kSolvedAgain = 0.02;  // share of blocks that disagree from which leaving them pays
constexpr double kLeastZncc = 0.3;
constexpr double kNearlyBlank_px = 0.05;  // standard error from which the spectrum is asked
constexpr double kSigmas = 4;
constexpr double kBetween =
    1.3;  // 1.2 of what is found on fresh copper, 0.7 of that on fresh steel
// The spectrum must promise clearly more.
constexpr double kPromise = 0.6;
// So must the photosites: of specks that are there, 0.7 of it and less.
constexpr double kSpecksPromise = 0.75;
constexpr double kLeastBlocks = 3.5;  // of a small picture, one or two mean nothing
constexpr int kMostFinest = 4;

void within(const char* field, double value, double least, double most) {
  if (value >= least && value <= most) return;
  throw CalibrationError(Exit::kUsage,
                         std::string("registration: ") + field + " is " + std::to_string(value) +
                             "; allowed: " + std::to_string(least) + " to " + std::to_string(most));
}

bool isShift(const Motion& m) {
  return m[0] == 1 && m[1] == 0 && m[3] == 0 && m[4] == 1 && m[6] == 0 && m[7] == 0;
}

int coarsestOf(const PreparedPicture& reference, const PreparedPicture& frame) {
  return static_cast<int>(std::min(reference.levels.size(), frame.levels.size())) - 1;
}

// Blocks that disagree pull at a least-squares fit: without them once more, at the level where
// they were found, then at the finer ones.
void leaveOutWhatDisagrees(const PreparedPicture& frame, const PreparedPicture& reference,
                           const AlignOptions& options, Alignment& out) {
  if (1 - out.agreement.share < kSolvedAgain || out.agreement.share < options.least_share) return;
  const LevelMask mask{out.agreement.level, agreeingPixels(out.agreement, reference)};
  const Refinement again =
      refineByEcc(reference, frame, out.frame_from_reference, options.model, mask);
  out.iterations += again.iterations;
  if (!again.converged) return;
  const Agreement agreement = agreementOf(reference, frame, again.frame_from_reference);
  if (agreement.zncc < out.agreement.zncc) return;
  out.agreement = agreement;
  out.frame_from_reference = again.frame_from_reference;
}

// Goes to a shift found in another way if it promises an error below `most_px` and is no farther
// away than errors of `before_px` are.
template <class Shift>
bool goesTo(const Shift& found, double most_px, double before_px, const PreparedPicture& frame,
            const PreparedPicture& reference, Alignment& out) {
  const double apart_px =
      cornersApart(found.frame_from_reference, out.frame_from_reference, reference.size());
  if (!(found.uncertainty_px < most_px) || apart_px > kSigmas * before_px) return false;
  out.frame_from_reference = found.frame_from_reference;
  out.agreement = agreementOf(reference, frame, found.frame_from_reference);
  return true;
}

// Of a surface that is nearly blank the finest level shows little but noise: matched once more by
// the frequencies that carry something.
void askTheSpectrum(const PreparedPicture& frame, const PreparedPicture& reference,
                    double before_px, Alignment& out) {
  const SpectralShift found =
      refineBySpectrum(reference, frame, out.frame_from_reference, out.agreement);
  // The spectrum's bound leaves out what the mosaic makes of specks, the blocks' error counts noise
  // that the spectrum passes over: in between.
  if (goesTo(found, kPromise * before_px, before_px, frame, reference, out))
    out.agreement.uncertainty_px = kBetween * std::sqrt(found.uncertainty_px * before_px);
}

// Where a few specks are all there is to see of a surface, what the mosaic makes of them is most of
// the error: matched once more by its own pixels.
void askThePhotosites(const PreparedPicture& frame, const PreparedPicture& reference,
                      double before_px, Alignment& out) {
  const MosaicShift found =
      refineByPhotosites(reference, frame, out.frame_from_reference, out.agreement);
  if (goesTo(found, kSpecksPromise * before_px, before_px, frame, reference, out))
    out.agreement.uncertainty_px = found.uncertainty_px;
}

Alignment alignFrom(const PreparedPicture& frame, const PreparedPicture& reference,
                    const Motion& start, const AlignOptions& options) {
  Alignment out;
  out.frame_from_reference = start;
  const int coarsest = coarsestOf(reference, frame);
  const int finest = std::min(options.finest_level, coarsest);
  Refinement refined;
  refined.frame_from_reference = start;
  if (isShift(start)) refined = refineTranslation(reference, frame, start);
  if (options.model != MotionModel::kTranslation) {
    // What is coarser than 128 px says little about a turn.
    int from = coarsest;
    while (from > finest && reference.levels[static_cast<std::size_t>(from)].size().width < 128)
      --from;
    const Refinement by_ecc =
        refineByEcc(reference, frame, refined.frame_from_reference, options.model, from, finest);
    refined.frame_from_reference = by_ecc.frame_from_reference;
    refined.iterations += by_ecc.iterations;
  }
  out.iterations = refined.iterations;
  out.frame_from_reference = refined.frame_from_reference;
  out.agreement = agreementOf(reference, frame, out.frame_from_reference);
  if (options.model != MotionModel::kTranslation) {
    leaveOutWhatDisagrees(frame, reference, options, out);
  } else if (const double before_px = out.agreement.uncertainty_px;
             before_px > kNearlyBlank_px && out.agreement.judged_blocks > 0) {
    askTheSpectrum(frame, reference, before_px, out);
    askThePhotosites(frame, reference, before_px, out);
  }
  out.verdict = verdictOf(out.agreement, options);
  return out;
}

bool isBetter(const Alignment& a, const Alignment& b) {
  return std::pair(a.agreement.share, a.agreement.zncc) >
         std::pair(b.agreement.share, b.agreement.zncc);
}

// From a pose, and where that took the mask to another place in the frame, from there once more.
template <class Prepared>
Alignment alignMasked(const Prepared& preparedFrom, const PreparedPicture& reference,
                      const Motion& start, const AlignOptions& options) {
  constexpr double kMaskMovedPx = 0.7;
  Alignment out = alignFrom(preparedFrom(start, true), reference, start, options);
  if (reference.mask.empty() || out.verdict == Verdict::kLost) return out;
  const Motion found = out.frame_from_reference;
  if (cornersApart(found, start, reference.size()) < kMaskMovedPx) return out;
  const int before = out.iterations;
  out = alignFrom(preparedFrom(found, true), reference, found, options);
  out.iterations += before;
  return out;
}

template <class Prepared>
Alignment alignSearching(const Prepared& preparedFrom, const PreparedPicture& reference,
                         const AlignOptions& options, Progress& progress) {
  options.check();
  progress.step(0);
  Alignment best = alignMasked(preparedFrom, reference, options.start, options);
  if (best.verdict != Verdict::kLost || !options.search) return best;
  const PreparedPicture& whole = preparedFrom(kNoMotion, false);
  const auto attempt = [&](const Motion& start, Start kind) {
    progress.step(0);
    Alignment other = alignMasked(preparedFrom, reference, start, options);
    other.start = kind;
    if (isBetter(other, best)) best = std::move(other);
  };
  if (const auto start = startByFeatures(reference, whole, options.model))
    attempt(*start, Start::kFeatures);
  if (best.verdict == Verdict::kLost) attempt(startByPhase(reference, whole), Start::kPhase);
  return best;
}

}  // namespace

void AlignOptions::check() const {
  within("finest_level", finest_level, 0, kMostFinest);
  within("least_share", least_share, 0, 1);
  within("least_contrast", least_contrast, 0, 1);
  within("least_sharpness", least_sharpness, 0, 1);
  within("most_uncertain_px", most_uncertain_px, 0, 100);
  within("most_covered", most_covered, 0, 1);
  within("least_spot", least_spot, 0, 1);
  if (model == MotionModel::kTranslation && !isShift(start))
    throw CalibrationError(Exit::kUsage, "registration: the start is no translation, the model is");
}

const char* name(Verdict verdict) {
  constexpr const char* kNames[] = {"good", "spot", "blurred", "fogged", "covered", "lost"};
  return kNames[static_cast<int>(verdict)];
}

std::string reasonOf(Verdict verdict, const Agreement& a, const AlignOptions& options) {
  const auto said = [](const char* format, double is, double wanted) {
    std::array<char, 160> text{};
    std::snprintf(text.data(), text.size(), format, is, wanted);
    return std::string(text.data());
  };
  switch (verdict) {
    case Verdict::kGood:
      return "";
    case Verdict::kSpot:
      return said("%.1f %% is something that was not there", 100 * a.covered, 0);
    case Verdict::kBlurred:
      return said("fine contrast is %.2f of the coarse, wanted %.2f",
                  a.contrast_fine / std::max(a.contrast_coarse, 1e-6), options.least_sharpness);
    case Verdict::kFogged:
      return said("contrast is %.2f of the reference's, wanted %.2f", a.contrast_coarse,
                  options.least_contrast);
    case Verdict::kCovered:
      return said("%.1f %% in one piece is something else, allowed %.1f %%", 100 * a.covered,
                  100 * options.most_covered);
    case Verdict::kLost:
      break;
  }
  if (a.judged_blocks == 0) return "nothing of the reference is seen";
  if (a.share < options.least_share)
    return said(
        "only %.0f %% of the blocks agree, wanted %.0f %%: hold on to what does not change, "
        "by fiducials",
        100 * a.share, 100 * options.least_share);
  if (a.zncc < kLeastZncc)
    return said("hardly alike: correlation %.2f, wanted %.2f", a.zncc, kLeastZncc);
  return said("too little structure: %.2f px expected, wanted %.2f px", a.uncertainty_px,
              options.most_uncertain_px);
}

bool isTrusted(Verdict verdict) { return verdict == Verdict::kGood || verdict == Verdict::kSpot; }

Verdict verdictOf(const Agreement& a, const AlignOptions& options) {
  if (a.judged_blocks == 0 || a.share < options.least_share || a.zncc < kLeastZncc ||
      !(a.uncertainty_px <= options.most_uncertain_px))
    return Verdict::kLost;
  if (a.covered > options.most_covered && a.covered * a.judged_blocks > kLeastBlocks)
    return Verdict::kCovered;
  if (a.contrast_fine < options.least_sharpness * a.contrast_coarse) return Verdict::kBlurred;
  if (a.contrast_coarse < options.least_contrast) return Verdict::kFogged;
  return a.covered >= options.least_spot ? Verdict::kSpot : Verdict::kGood;
}

Image<std::uint8_t> maskMoved(ImageView<const std::uint8_t> mask,
                              const Motion& frame_from_reference, SizePx frame) {
  const Motion back = inverse(frame_from_reference);
  Image<std::uint8_t> out(frame.width, frame.height, 1);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const PlacePx p = moved(back, {static_cast<double>(x), static_cast<double>(y)});
      const int px = static_cast<int>(std::lround(p.x)), py = static_cast<int>(std::lround(p.y));
      if (px >= 0 && py >= 0 && px < mask.width && py < mask.height) out.at(x, y) = mask.at(px, py);
    }
  return out;
}

Image<std::uint8_t> maskInFrame(const PreparedPicture& reference, const Motion& motion,
                                SizePx frame) {
  if (reference.mask.empty()) return {};
  return maskMoved(reference.mask.view(), motion, frame);
}

Alignment align(ImageView<const float> frame, const PreparedPicture& reference,
                const AlignOptions& options, Progress& progress) {
  const int levels = static_cast<int>(reference.levels.size());
  return alignSearching(
      [&](const Motion& start, bool masked) {
        const Image<std::uint8_t> mask =
            masked ? maskInFrame(reference, start, frame.size()) : Image<std::uint8_t>();
        if (mask.empty()) return preparePicture(frame, {}, levels);
        return preparePicture(frame, std::as_const(mask).view(), levels);
      },
      reference, options, progress);
}

Alignment align(const PreparedPicture& frame, const PreparedPicture& reference,
                const AlignOptions& options, Progress& progress) {
  return alignSearching([&](const Motion&, bool) -> const PreparedPicture& { return frame; },
                        reference, options, progress);
}

}  // namespace patina::calibration
