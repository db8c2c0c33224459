// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lamp_confirmation.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <set>
#include <utility>

#include "calibration/lamps/lit_lamp.h"
#include "calibration/lamps/reduced_grey.h"
#include "capture/workflow/failure.h"

namespace patina::workflow {
namespace {

constexpr std::size_t kToldMost = 10;
constexpr int kSidePx = 384;  // of what is kept of a frame: eight texels a block

// The frames of one light state, the next of them at hand.
struct State {
  std::unique_ptr<ArchiveFrames> frames;
  std::optional<ttf::SourceFrame> next;
  Image<float> reference;  // reduced; of the last frame that was confirmed

  void advance() { next = frames->next(); }
};

Image<float> reduced(const Image<float>& linear) {
  return calibration::reducedGrey(linear.view(), calibration::reductionTo(kSidePx, linear.size()));
}

std::vector<std::string> statesOf(const db::ArchiveReader& reader, const std::string& run_id,
                                  const std::string& camera) {
  std::set<std::string> states;
  reader.eachFrame(run_id, [&](const db::ArchiveReader::CapturedFrame& one) {
    if ((camera.empty() || one.shot.device_id == camera) && one.shot.light_state != "off")
      states.insert(one.shot.light_state);
  });
  if (states.size() < 2)
    throw WorkflowError(Exit::kUsage, run_id +
                                          " has one light state: its lamp is told from another's "
                                          "shading, and there is no other");
  return {states.begin(), states.end()};
}

void count(const calibration::LitLamp& found, std::size_t own, StateConfirmation& state) {
  ++state.frames;
  if (found.verdict == calibration::LitLamp::kDark) {
    ++state.dark;
  } else if (found.verdict == calibration::LitLamp::kUnclear) {
    ++state.unclear;
  } else if (found.lamp != static_cast<int>(own)) {
    ++state.other;
  } else {
    ++state.confirmed;
    state.margin_least = std::min(state.margin_least, found.margin);
  }
}

std::string textOf(const calibration::LitLamp& found, const std::vector<StateConfirmation>& of) {
  if (found.verdict == calibration::LitLamp::kDark) return "no lamp was lit";
  if (found.verdict == calibration::LitLamp::kUnclear) return "no known lamp's shading";
  return "lit by " + of[static_cast<std::size_t>(found.lamp)].light;
}

}  // namespace

bool LampConfirmation::all() const {
  return std::ranges::all_of(states, [](const auto& s) { return s.confirmed == s.frames; });
}

std::string LampConfirmation::verdict() const {
  if (all()) return "Every frame has the light that its row says.";
  std::int64_t frames = 0, wrong = 0, unsure = 0;
  for (const StateConfirmation& state : states) {
    frames += state.frames;
    wrong += state.other + state.dark;
    unsure += state.unclear;
  }
  const std::string of = " of " + std::to_string(frames) + " frames ";
  if (wrong == 0)
    return std::to_string(unsure) + of + "have a shading that is no lamp's; none has another's.";
  return std::to_string(wrong) + of + "have another light than their row says.";
}

LampConfirmation confirmLamps(const db::ArchiveReader& reader, const std::string& run_id,
                              const FrameSelection& selection, Progress& progress) {
  LampConfirmation out;
  std::vector<State> states;
  std::int64_t frames = 0;
  for (const std::string& light : statesOf(reader, run_id, selection.camera)) {
    FrameSelection one = selection;
    one.light = light;
    states.emplace_back();
    states.back().frames =
        std::make_unique<ArchiveFrames>(reader, run_id, one, Correction{.light_gain = false});
    out.camera = states.back().frames->report().camera;
    states.back().advance();
    states.back().reference = reduced(states.back().next->linear);
    frames += states.back().frames->count();
    out.states.emplace_back().light = light;
  }
  const UtcTime t0 = reader.findRun(run_id).t0_utc;
  std::size_t more = 0;
  progress.begin("frames", frames);
  for (;;) {
    const auto at = std::ranges::min_element(states, {}, [](const State& s) {
      return s.next ? s.next->time_s : std::numeric_limits<double>::infinity();
    });
    if (!at->next) break;
    const auto own = static_cast<std::size_t>(at - states.begin());
    Image<float> frame = reduced(at->next->linear);
    std::vector<ImageView<const float>> references;
    for (const State& state : states) references.push_back(std::as_const(state.reference).view());
    const calibration::LitLamp found =
        calibration::confirmLitLamp(std::as_const(frame).view(), references, {});
    count(found, own, out.states[own]);
    const bool confirmed =
        found.verdict == calibration::LitLamp::kLit && found.lamp == static_cast<int>(own);
    if (confirmed)
      at->reference = std::move(frame);
    else if (out.told.size() < kToldMost)
      out.told.push_back(formatUtc(t0 + fromSeconds(at->next->time_s)) + " " +
                         out.states[own].light + ": " + textOf(found, out.states));
    else
      ++more;
    at->advance();
    progress.step();
  }
  if (more > 0) out.told.push_back("and " + std::to_string(more) + " more");
  return out;
}

}  // namespace patina::workflow
