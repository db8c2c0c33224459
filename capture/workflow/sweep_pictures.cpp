// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sweep_pictures.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "capture/workflow/failure.h"
#include "capture/workflow/picture_times.h"
#include "processing/image/parallel_rows.h"

namespace patina::workflow {
namespace {

using Captured = db::ArchiveReader::CapturedFrame;

bool isLamp(const std::string& state) {
  return state != "off" && state.find('+') == std::string::npos;
}

// The one asked for, or the only one.
std::string pick(const std::set<std::string>& there, const std::string& asked,
                 const std::string& what, const std::string& option, const std::string& run) {
  if (asked.empty() && there.size() == 1) return *there.begin();
  if (there.contains(asked)) return asked;
  std::string choices;
  for (const std::string& one : there) choices.append(choices.empty() ? "" : ", ").append(one);
  throw WorkflowError(
      Exit::kUsage,
      asked.empty() ? run + " has several " + what + "s; choose one by " + option + ": " + choices
                    : run + " has no " + what + " '" + asked + "'; there are: " + choices);
}

std::int64_t nsOf(double time_s) { return std::llround(time_s * 1e9); }

}  // namespace

SweepPlan planSweeps(const db::ArchiveReader& reader, const std::string& run_id,
                     const FrameSelection& selection) {
  const db::RunRow run = reader.findRun(run_id);
  std::set<std::string> cameras, exposures, lamps, others;
  reader.eachFrame(run.id, [&](const Captured& one) {
    if (!one.step.number || one.frame.file_index != selection.file_index) return;
    cameras.insert(one.shot.device_id);
    exposures.insert(std::to_string(one.shot.exposure_index));
  });
  if (cameras.empty()) throw WorkflowError(Exit::kBadData, run.id + " has no frames");
  SweepPlan plan;
  plan.camera = pick(cameras, selection.camera, "camera", "--camera", run.id);
  if (!selection.merged)
    pick(exposures, selection.exposure ? std::to_string(*selection.exposure) : "", "exposure",
         "--exposure", run.id);
  struct Span {
    double first = HUGE_VAL, last = -HUGE_VAL;
    SweepStep step;
  };
  std::map<std::int64_t, Span> whole;
  std::set<std::int64_t> partial;
  reader.eachFrame(run.id, [&](const Captured& one) {
    if (!one.step.number || one.frame.file_index != selection.file_index ||
        one.shot.device_id != plan.camera)
      return;
    if (!selection.merged && selection.exposure && one.shot.exposure_index != *selection.exposure)
      return;
    if (!isLamp(one.shot.light_state)) {
      if (one.shot.light_state != "off") others.insert(one.shot.light_state);
      return;
    }
    lamps.insert(one.shot.light_state);
    if (one.step.decision != db::Decision::kCaptured ||
        one.step.shots_captured < one.step.shots_due) {
      partial.insert(*one.step.number);
      return;
    }
    Span& span = whole[*one.step.number];
    const double time_s = toSeconds(one.frame.utc - run.t0_utc);
    span.first = std::min(span.first, time_s);
    span.last = std::max(span.last, time_s);
    span.step.number = *one.step.number;
    span.step.frame_sha256s.push_back(one.frame.sha256.hex());
    span.step.frame_ids.push_back(one.frame.id);
  });
  if (lamps.empty())
    throw WorkflowError(Exit::kBadData, run.id +
                                            " has no shots under one lamp alone; give its plan "
                                            "lights = [[\"a\"], [\"b\"], ...]");
  std::int64_t index = 0;
  for (auto& [number, span] : whole) {
    if (index++ % selection.every != 0) continue;
    span.step.time_s = (span.first + span.last) / 2;
    plan.steps.push_back(std::move(span.step));
  }
  plan.states.assign(lamps.begin(), lamps.end());
  std::sort(plan.states.begin(), plan.states.end(), naturalLess);
  plan.partial.assign(partial.begin(), partial.end());
  plan.other_states.assign(others.begin(), others.end());
  return plan;
}

Sweeps::Sweeps(const db::ArchiveReader& reader, const db::RunRow& run, const SweepPlan& plan,
               const FrameRequest& request, std::size_t from, Progress& progress)
    : plan_(plan), at_(from) {
  std::map<std::int64_t, std::size_t> index_of;
  for (std::size_t k = 0; k < plan.steps.size(); ++k) index_of[plan.steps[k].number] = k;
  reader.eachFrame(run.id, [&](const Captured& one) {
    const auto step = one.step.number ? index_of.find(*one.step.number) : index_of.end();
    if (step != index_of.end())
      step_of_[{one.frame.sha256.hex(), nsOf(toSeconds(one.frame.utc - run.t0_utc))}] =
          step->second;
  });
  FrameRequest of_state = request;
  of_state.selection.camera = plan.camera;
  of_state.laid_later = request.registration.has_value();
  // Poses hang together from the first frame on: a registered run is gone through whole.
  if (!request.registration && from > 0) of_state.selection.from_step = plan.steps[from - 1].number;
  for (const std::string& state : plan.states) {
    of_state.selection.light = state;
    auto stream = std::make_unique<Stream>();
    stream->chain = std::make_unique<FrameChain>(reader, run, of_state, progress);
    streams_.push_back(std::move(stream));
  }
  if (!request.registration) return;
  std::optional<PixelMap> map;
  if (const auto& rectified = chain(0).rectification()) map = rectified->map;
  registered_.emplace(*request.registration, plan.states, std::move(map), progress);
}

Sweeps::~Sweeps() = default;

bool SweepPictures::anyResampled() const {
  return std::ranges::any_of(pictures, &SweepPicture::resampled);
}

// Past frames of steps that are read: of several of one lamp in a step the first counts.
void Sweeps::lookAhead(Stream& stream) {
  while (!stream.ended && !stream.ahead) {
    std::optional<ttf::SourceFrame> frame = stream.chain->source().next();
    stream.ended = !frame;
    if (!frame) return;
    const auto step = step_of_.find({frame->source.hex(), nsOf(frame->time_s)});
    if (step != step_of_.end() && (!read_ || step->second > *read_))
      stream.ahead = Frame{step->second, frame->time_s, std::move(frame->linear)};
  }
}

bool Sweeps::readStep() {
  std::optional<std::size_t> step;
  for (const auto& stream : streams_) {
    lookAhead(*stream);
    if (stream->ahead) step = std::min(step.value_or(stream->ahead->step), stream->ahead->step);
  }
  if (!step) return false;
  read_ = step;
  const bool wanted = *step + 1 >= at_;
  std::vector<SweepPicture> pictures;
  std::vector<double> times_s(streams_.size());
  for (std::size_t i = 0; i < streams_.size(); ++i) {
    std::optional<Frame>& ahead = streams_[i]->ahead;
    if (!ahead || ahead->step != *step) continue;
    times_s[i] = ahead->time_s;
    pictures.push_back({i, std::move(ahead->linear), false});
    ahead.reset();
  }
  std::ranges::sort(pictures, {}, [&](const SweepPicture& one) { return times_s[one.state]; });
  if (registered_) registered_->lay(plan_.steps[*step].number, pictures, wanted);
  if (!wanted) return true;
  for (SweepPicture& one : pictures) {
    std::deque<Frame>& frames = streams_[one.state]->frames;
    frames.push_back({*step, times_s[one.state], std::move(one.linear), one.resampled});
    while (frames.front().step + 1 < at_) frames.pop_front();
  }
  return true;
}

std::optional<SweepPicture> Sweeps::ofMoment(std::size_t state, std::size_t step) const {
  const std::deque<Frame>& frames = streams_[state]->frames;
  const auto frameOf = [&](std::size_t of) {
    const auto found = std::ranges::find(frames, of, &Frame::step);
    return found == frames.end() ? nullptr : &*found;
  };
  const Frame* own = frameOf(step);
  if (!own) return std::nullopt;
  const auto neighbour = [&](const Frame* frame) -> std::optional<TimedPicture> {
    if (!frame || frame->time_s == own->time_s) return std::nullopt;
    return TimedPicture{frame->time_s - own->time_s, frame->linear.view()};
  };
  SweepPicture picture{state, own->linear, own->resampled};
  moveInTime(picture.linear, neighbour(step > 0 ? frameOf(step - 1) : nullptr),
             neighbour(frameOf(step + 1)), plan_.steps[step].time_s - own->time_s);
  return picture;
}

std::optional<SweepPictures> Sweeps::next() {
  if (at_ >= plan_.steps.size()) return std::nullopt;
  while ((!read_ || *read_ <= at_) && readStep()) {
  }
  SweepPictures out;
  out.number = plan_.steps[at_].number;
  for (std::size_t i = 0; i < streams_.size(); ++i)
    if (auto picture = ofMoment(i, at_)) out.pictures.push_back(std::move(*picture));
  ++at_;
  return out;
}

namespace {

// Of a curve through three points that is monotone where they are (Fritsch and Butland 1984): the
// harmonic mean of both sides' slopes, weighted by their spans; none at a peak.
double slopeWithin(double before, double before_s, double behind, double behind_s) {
  if (before * behind <= 0) return 0;
  const double one = 2 * behind_s + before_s, two = behind_s + 2 * before_s;
  return (one + two) / (one / before + two / behind);
}

}  // namespace

void moveInTime(Image<float>& picture, const std::optional<TimedPicture>& before,
                const std::optional<TimedPicture>& behind, double by_s) {
  if (!before && !behind) return;
  const int row = picture.width() * picture.channels();
  forEachRow(picture.height(), std::int64_t{row} * 16, [&](int y) {
    float* level = &picture.at(0, y);
    const auto slopeTo = [&](const TimedPicture& other, int i) {
      return (double{other.linear.row(y)[i]} - level[i]) / other.after_s;
    };
    for (int i = 0; i < row; ++i) {
      double slope = slopeTo(before ? *before : *behind, i);
      if (before && behind)
        slope = slopeWithin(slope, -before->after_s, slopeTo(*behind, i), behind->after_s);
      const auto moved = static_cast<float>(level[i] + slope * by_s);
      level[i] = std::isnan(moved) ? level[i] : moved;
    }
  });
}

}  // namespace patina::workflow
