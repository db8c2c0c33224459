// SPDX-License-Identifier: GPL-3.0-or-later
// The sweeps of a run over its lamps, one whole step at a time: a picture a lamp, calibrated, all
// as of one moment.
#pragma once

#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "capture/workflow/frame_chain.h"
#include "capture/workflow/registered_sweeps.h"

namespace patina::workflow {

// A whole step of one camera and exposure, as the catalogue has it.
struct SweepStep {
  std::int64_t number = 0;
  double time_s = 0;                       // from t0: middle between its first and last frame
  std::vector<std::string> frame_sha256s;  // of all its frames of this camera, in order
  std::vector<db::RowId> frame_ids;
};
struct SweepPlan {
  std::string camera;
  std::vector<std::string> states;        // of one lamp each, in natural order
  std::vector<SweepStep> steps;           // those that are whole, every n-th, in order
  std::vector<std::int64_t> partial;      // numbers of those left out
  std::vector<std::string> other_states;  // several lamps at once: left out
};
// `selection`: camera, exposure, every. Throws WorkflowError: kUsage with the choices where a run
// has several cameras or exposures; kBadData where it has no whole step, or no lamp alone.
SweepPlan planSweeps(const db::ArchiveReader& reader, const std::string& run_id,
                     const FrameSelection& selection);

struct SweepPictures {
  std::int64_t number = 0;
  std::vector<SweepPicture> pictures;  // states whose frame was refused are not there
  bool anyResampled() const;
};

// Frames are pulled step by step, and where they are to be registered, laid over the first step
// together (RegisteredSweeps). The step before and the one behind that at hand are in memory, and
// one picture more a lamp: four. A picture is brought to its step's moment along the slope that its
// lamp's pictures of the steps before and behind give (moveInTime); no others take part.
// Thread-bound; reader and progress outlive it.
class Sweeps {
 public:
  // `request`: its selection's light and `from_step` are filled in. Pictures begin at `from`, an
  // index of the plan's steps.
  Sweeps(const db::ArchiveReader& reader, const db::RunRow& run, const SweepPlan& plan,
         const FrameRequest& request, std::size_t from, Progress& progress);
  ~Sweeps();

  std::optional<SweepPictures> next();
  const FrameChain& chain(std::size_t state) const { return *streams_[state]->chain; }
  // What registration left out or took for ageing so far.
  std::vector<std::string> notes() const {
    return registered_ ? registered_->notes() : std::vector<std::string>();
  }

 private:
  struct Frame {
    std::size_t step = 0;  // of the plan
    double time_s = 0;
    Image<float> linear;
    bool resampled = false;
  };
  struct Stream {
    std::unique_ptr<FrameChain> chain;
    std::optional<Frame> ahead;  // the next one, of a step that is not read yet
    std::deque<Frame> frames;    // of steps that are, in order
    bool ended = false;
  };
  void lookAhead(Stream& stream);
  bool readStep();  // the next one that has frames, of all streams; false when there is none
  std::optional<SweepPicture> ofMoment(std::size_t state, std::size_t step) const;

  const SweepPlan plan_;
  std::size_t at_;
  std::optional<std::size_t> read_;                                      // the last step that was
  std::map<std::pair<std::string, std::int64_t>, std::size_t> step_of_;  // by hash and time, ns
  std::vector<std::unique_ptr<Stream>> streams_;
  std::optional<RegisteredSweeps> registered_;
};

// The same view at another time.
struct TimedPicture {
  double after_s = 0;  // below 0: before
  ImageView<const float> linear;
};
// The picture as of `by_s` later, in place: along the slope of a curve through it and its
// neighbours in time that is monotone where they are, so what changes at once between two of them,
// and stands still on the other side, is not smeared. With one neighbour, along the line to it.
// Levels that are not known in all stay as they are.
void moveInTime(Image<float>& picture, const std::optional<TimedPicture>& before,
                const std::optional<TimedPicture>& behind, double by_s);

}  // namespace patina::workflow
