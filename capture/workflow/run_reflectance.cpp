// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_reflectance.h"

#include <algorithm>
#include <cmath>

#include "capture/workflow/failure.h"
#include "capture/workflow/folder_lock.h"
#include "capture/workflow/sweep_fit.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;

// 12 bits; electrons of a middling camera, read noise of a poor one.
constexpr calibration::NoiseModel kUnknownCamera{.electrons_per_number = 15000.0 / 4095,
                                                 .read_noise_e = 5,
                                                 .full_well_e = 15000,
                                                 .white_level = 4095};

fs::path folderOf(const fs::path& archive, const RunReflectanceRequest& request,
                  const std::string& id) {
  return request.out.empty() ? db::ProductWriter::folderFor(archive, id)
                             : fs::absolute(request.out).lexically_normal();
}

class RunFit {
 public:
  RunFit(const fs::path& archive, const RunReflectanceRequest& request, Progress& progress)
      : archive_(archive),
        request_(request),
        progress_(progress),
        reader_(archive),
        run_(reader_.findRun(request.run)),
        plan_(planSweeps(reader_, run_.id, request.frames.selection)) {
    if (plan_.steps.empty())
      throw WorkflowError(Exit::kBadData,
                          run_.id + " has no whole step yet; partial ones are left out");
    outcome_.run_id = run_.id;
    outcome_.camera = plan_.camera;
    outcome_.partial = plan_.partial;
    const std::string of = run_.id + "-" + plan_.camera + (request.after.empty() ? "" : "-after");
    id_ = freeProductId(reader_, "brdf", of);
    outcome_.set = folderOf(archive, request, id_);
    for (const std::string& state : plan_.other_states)
      outcome_.warnings.push_back("light state " + state +
                                  " has several lamps at once and is left out");
  }

  RunReflectanceOutcome run(UtcTime now) {
    const std::size_t count = plan_.steps.size() - (request_.so_far ? 1 : 0);
    if (count == 0) return std::move(outcome_);
    refuseOther();
    const FolderLock lock(outcome_.set);
    // Calibrations and lights are those of any step's frames: found out on the first.
    sweeps_ = std::make_unique<Sweeps>(reader_, run_, plan_, frames(), 0, progress_);
    prepare(*sweeps_);
    describe(*sweeps_);
    std::size_t at = 0;  // of the pictures
    for (std::size_t step = 0; step < count; ++step) {
      const std::string print = stepPrint(step);
      if (isThere(print)) {
        keepStep(step, print, false, {}, 0);
        continue;
      }
      if (at != step)
        sweeps_ = std::make_unique<Sweeps>(reader_, run_, plan_, frames(), step, progress_);
      fitStep(step, print, *sweeps_->next());
      at = step + 1;
    }
    for (const std::string& note : sweeps_->notes()) outcome_.warnings.push_back(note);
    if (!request_.so_far) finish(*sweeps_, now);
    return std::move(outcome_);
  }

 private:
  FrameRequest frames() const {
    FrameRequest frames = request_.frames;
    frames.white = true;
    frames.correction.clipped = Clipped::kUnknown;
    return frames;
  }

  // A set that is finished, and what is none, is not written into.
  void refuseOther() const {
    if (request_.out.empty() || !fs::exists(outcome_.set) || fs::is_empty(outcome_.set)) return;
    const bool begun =
        brdf::brdfStepIsThere(outcome_.set, 0) || fs::exists(outcome_.set / "pixels");
    if (fs::exists(outcome_.set / "manifest.json") || !begun)
      throw WorkflowError(Exit::kCannotCreate, outcome_.set.string() + " is there already");
  }

  RectPx regionOf(SizePx whole) const {
    const RectPx all{0, 0, whole.width, whole.height};
    if (!request_.region || request_.frames.rectify) return wholeTexels(all, request_.bin);
    RectPx r = *request_.region;
    if (r.x < 0 || r.y < 0 || r.x + r.width > whole.width || r.y + r.height > whole.height)
      throw WorkflowError(Exit::kUsage, "the region does not lie within the frames of " +
                                            std::to_string(whole.width) + "x" +
                                            std::to_string(whole.height) + " pixels");
    return wholeTexels(r, request_.bin);
  }

  void prepare(const Sweeps& sweeps) {
    const FrameChain& chain = sweeps.chain(0);
    const SizePx whole = chain.size();
    fit_.bin = request_.bin;
    fit_.region = regionOf(whole);
    const double mm = chain.mmPerTexel() > 0 ? chain.mmPerTexel() : request_.mm_per_pixel;
    mm_per_texel_ = mm * request_.bin;
    outcome_.mm_per_texel = mm_per_texel_;
    double x_mm = (fit_.region.x + fit_.region.width / 2.0 - whole.width / 2.0) * mm,
           y_mm = (whole.height / 2.0 - fit_.region.y - fit_.region.height / 2.0) * mm;
    if (const auto& rectified = chain.rectification()) {
      x_mm += rectified->region.left + rectified->region.width / 2;
      y_mm += rectified->region.bottom + rectified->region.height / 2;
    }
    RunLightsRequest lights{request_.lights, request_.rig, request_.frames.rectify.has_value(),
                            request_.frames.correction.stale};
    const RunLights found =
        lightsOfRun(reader_, keyOf(chain.frames(), run_.t0_utc), plan_.states, lights);
    for (std::size_t i = 0; i < plan_.states.size(); ++i)
      addLight(found.lights[i], sweeps.chain(i), x_mm, y_mm);
    light_calibrations_ = found.used;
    outcome_.warnings.insert(outcome_.warnings.end(), found.left.begin(), found.left.end());
    warnOfWhite();
    brdf::MultiLightOptions& options = fit_.options = request_.fit;
    options.mm_per_texel = mm > 0 ? static_cast<float>(mm) : 1;
    options.saturated = 1e6f;  // what is clipped is not known
    options.deep_shadows = true;
    options.neighbour_px = std::min(request_.fit.neighbour_px * request_.bin, 256);
    options.noise = noiseOfPixels(noiseOf(chain), fit_.states, chain.frames().as_short);
    if (const auto filters = chain.filters())
      options.filters = filtersAt(*filters, fit_.region.x, fit_.region.y);
    if (request_.earlier_steps && options.model != brdf::Model::kLambert)
      fit_.pixels = outcome_.set / "pixels";
  }

  // A lamp of unknown distance over texels of unknown size is as far away as can be.
  brdf::SurfaceLight overMap(const brdf::SurfaceLight& light, double x_mm, double y_mm) const {
    if (!light.near || mm_per_texel_ > 0) return seenFrom(light, x_mm, y_mm);
    brdf::SurfaceLight distant;
    distant.direction = brdf::normalized(light.position_mm);
    distant.strength = 1 / distant.direction.z;
    return distant;
  }

  void addLight(const RunLight& found, const FrameChain& chain, double x_mm, double y_mm) {
    StateLight state;
    state.light = overMap(found.light, x_mm, y_mm);
    const std::optional<double> by_card = chain.whiteLevel();
    state.even = by_card.has_value();
    state.white_level = by_card ? *by_card : found.strength_known ? 1 : request_.white_level;
    state.by_patch = chain.frames().held_to_patch;
    std::string how = by_card ? "white by card" : "white as told";
    if (state.by_patch) how += ", held by the patch";
    if (!by_card && found.strength_known) how = "white by its strength";
    outcome_.lights.push_back(found.state + ": " + found.from + "; " + how);
    if (!found.sha256.empty()) light_sha256s_.push_back(found.sha256);
    fit_.states.push_back(state);
  }

  void warnOfWhite() {
    const auto told = std::ranges::count_if(
        outcome_.lights, [](const std::string& light) { return light.ends_with("white as told"); });
    if (told > 0)
      outcome_.warnings.push_back(
          "nothing in the archive tells what white is under " + std::to_string(told) + " of " +
          std::to_string(outcome_.lights.size()) +
          " lamps: each is taken to light a white card in the middle to " +
          std::to_string(request_.white_level) +
          " of full scale; run `patina calibrate field` on pictures of a card, or `patina "
          "calibrate albedo`");
  }

  calibration::NoiseModel noiseOf(const FrameChain& chain) {
    if (const auto noise = chain.noise()) return (*noise)[1];
    outcome_.warnings.push_back(
        "no photon transfer of this camera: it is taken to hold 15,000 electrons; run `patina "
        "calibrate noise`");
    return kUnknownCamera;
  }

  // What every step's result depends on, besides its frames.
  void describe(const Sweeps& sweeps) {
    making_ = {request_.command, {}, 0, request_.version, {}};
    sweeps.chain(0).addOptions(making_.options);
    Facts& options = making_.options;
    options.text("model", brdf::nameOf(fit_.options.model)).set("lights", outcome_.lights);
    options.count("states", static_cast<std::int64_t>(fit_.states.size()));
    options.text("region", rectText(fit_.region)).number("mm_per_texel", mm_per_texel_);
    options.count("bin", request_.bin);
    options.set("mosaic", fit_.options.filters.has_value());
    options.number("white_level", request_.white_level);
    options.set("neighbours", fit_.options.neighbours).set("earlier_steps", request_.earlier_steps);
    options.number("noise_floor", fit_.options.noise.floor)
        .number("noise_shot", fit_.options.noise.shot);
    options.number("noise_gain", fit_.options.noise.gain);
    options.number("specular_spread", fit_.options.specular_spread);
    common_ = request_.version + "\n";
    Facts common;  // the masters of a step are those bound to its own frames
    for (const auto& [key, value] : options.all())
      if (key != "masters") common.set(key, value);
    common_.append(common.json()).append("\n");
    for (std::size_t i = 0; i < fit_.states.size(); ++i) {
      const brdf::SurfaceLight& light = fit_.states[i].light;
      for (const float v : {light.direction.x, light.direction.y, light.direction.z,
                            light.position_mm.x, light.position_mm.y, light.position_mm.z,
                            light.strength, static_cast<float>(fit_.states[i].white_level)})
        common_.append(std::to_string(v)).append(" ");
      addCalibrations(sweeps.chain(i));
    }
    for (const std::string& sha256 : light_sha256s_) common_.append(sha256).append("\n");
    for (const std::string& sha256 : light_sha256s_) addInput(sha256);
  }

  void addInput(const std::string& sha256) {
    auto& inputs = making_.input_sha256s;
    if (std::ranges::find(inputs, sha256) == inputs.end()) inputs.push_back(sha256);
  }

  // Masters and fields; of frames only those of the steps at hand matter to a step.
  void addCalibrations(const FrameChain& chain) {
    Making of_chain;
    chain.addInputs(of_chain);
    const auto frames = static_cast<std::size_t>(chain.frames().frames) *
                        static_cast<std::size_t>(chain.frames().exposures);
    for (std::size_t i = frames; i < of_chain.input_sha256s.size(); ++i)
      addInput(of_chain.input_sha256s[i]);
    for (const db::FrameCalibrationRow& row : chain.bindings())
      bound_[row.frame_id].push_back(row.calibration_id);
  }

  std::string stepPrint(std::size_t step) const {
    std::string text = common_ + print_before_;
    const std::size_t last = std::min(step + 1, plan_.steps.size() - 1);
    for (std::size_t k = step > 0 ? step - 1 : 0; k <= last; ++k) {
      const SweepStep& of = plan_.steps[k];
      for (const std::string& frame : of.frame_sha256s) text.append(frame).append("\n");
      for (const db::RowId frame : of.frame_ids)
        if (const auto bound = bound_.find(frame); bound != bound_.end())
          for (const db::RowId calibration : bound->second)
            text.append(std::to_string(calibration)).append(" ");
    }
    return sha256(text).hex();
  }

  // The set's next step.
  int next() const { return static_cast<int>(outcome_.steps.size()); }

  bool isThere(const std::string& print) const {
    if (!brdf::brdfStepIsThere(outcome_.set, next())) return false;
    return brdf::readManifest(brdf::brdfStepFolder(outcome_.set, next())).text("made_of_sha256") ==
           print;
  }

  brdf::BrdfSetInfo infoOfSteps() const {
    brdf::BrdfSetInfo info;
    info.model = fit_.options.model;
    if (info.model == brdf::Model::kTorranceSparrow) info.roughness = brdf::RoughnessKind::kSigma;
    for (const FittedStep& step : outcome_.steps) info.times.push_back(step.time_s);
    return info;
  }

  void keepStep(std::size_t step, const std::string& print, bool fitted,
                const brdf::MultiLightReport& report, std::size_t lights) {
    outcome_.steps.push_back({plan_.steps[step].number, plan_.steps[step].time_s, fitted,
                              static_cast<std::int64_t>(lights), report});
    print_before_ = print;
  }

  // A step whose frames were refused under so many lamps that the rest do not tell reflectance is
  // left out.
  void fitStep(std::size_t step, const std::string& print, const SweepPictures& sweep) {
    brdf::MultiLightFit fit;
    try {
      fit = fitSweep(fit_, sweep, next(), progress_);
    } catch (const ProcessingError& error) {
      if (error.exit() != Exit::kBadData || sweep.pictures.size() == plan_.states.size()) throw;
      if (outcome_.left_out.empty()) first_left_ = error.what();
      outcome_.left_out.push_back(plan_.steps[step].number);
      outcome_.warnings.push_back("step " + std::to_string(plan_.steps[step].number) +
                                  " left out: " + error.what());
      return;
    }
    brdf::BrdfSetInfo info = infoOfSteps();
    info.times.push_back(plan_.steps[step].time_s);
    info.facts.text("made_of_sha256", print);
    info.facts.count("step", plan_.steps[step].number);
    info.facts.count("lights", static_cast<std::int64_t>(sweep.pictures.size()));
    info.facts.set("resampled", sweep.anyResampled());
    info.facts.number("residual_rms", fit.report.residual_rms);
    brdf::writeBrdfStep(outcome_.set, info, next(), fit.maps);
    keepStep(step, print, true, fit.report, sweep.pictures.size());
  }

  void finish(const Sweeps& sweeps, UtcTime now) {
    if (outcome_.steps.empty())
      throw WorkflowError(Exit::kBadData,
                          "every step is left out, the first because " + first_left_);
    for (std::size_t i = 0; i < fit_.states.size(); ++i) {
      const FrameChain& chain = sweeps.chain(i);
      for (const std::string& used : chain.calibrations())
        if (std::ranges::find(outcome_.calibrations, used) == outcome_.calibrations.end())
          outcome_.calibrations.push_back(used);
      for (const std::string& left : chain.left())
        if (std::ranges::find(outcome_.warnings, left) == outcome_.warnings.end())
          outcome_.warnings.push_back(left);
      if (const auto bindings = chain.bindings(); !bindings.empty())
        db::ProductWriter::bind(archive_, bindings);
    }
    for (const SweepStep& step : plan_.steps)
      for (const std::string& frame : step.frame_sha256s) making_.input_sha256s.push_back(frame);
    brdf::BrdfSetInfo info = infoOfSteps();
    const Facts made = making_.facts();
    info.facts.text("command", request_.command).text("version", request_.version);
    info.facts.text("run_id", run_.id).text("inputs_sha256", *made.text("inputs_sha256"));
    info.facts.text("made_of_sha256", print_before_);
    info.facts.number("mm_per_texel", mm_per_texel_).set("lights", outcome_.lights);
    std::vector<double> numbers;
    for (const FittedStep& step : outcome_.steps)
      numbers.push_back(static_cast<double>(step.number));
    info.facts.set("steps", numbers);
    for (int step = next(); brdf::brdfStepIsThere(outcome_.set, step); ++step)
      fs::remove_all(brdf::brdfStepFolder(outcome_.set, step));  // of other options, once
    fs::remove_all(outcome_.set / "pixels");
    brdf::finishBrdfSet(outcome_.set, info);
    record(now);
  }

  void record(UtcTime now) {
    Facts metadata;
    metadata.text("specimen", run_.specimen).text("camera", plan_.camera);
    metadata.count("steps", next());
    metadata.count("steps_partial_left_out", static_cast<std::int64_t>(plan_.partial.size()));
    metadata.count("steps_refused", static_cast<std::int64_t>(outcome_.left_out.size()));
    metadata.count("t0_utc_ns", toNs(run_.t0_utc)).number("mm_per_texel", mm_per_texel_);
    if (!request_.after.empty()) metadata.text("after", request_.after);
    const ProductFile file{id_, outcome_.set / "manifest.json", request_.out.empty()};
    outcome_.product = recordProduct(archive_, file, "brdf", run_.id, making_, metadata, now);
  }

  const fs::path archive_;
  const RunReflectanceRequest& request_;
  Progress& progress_;
  const db::ArchiveReader reader_;
  const db::RunRow run_;
  const SweepPlan plan_;
  std::string id_;
  RunReflectanceOutcome outcome_;
  SweepFit fit_;
  std::unique_ptr<Sweeps> sweeps_;
  double mm_per_texel_ = 0;
  std::vector<RunCalibration> light_calibrations_;
  std::vector<std::string> light_sha256s_;
  Making making_;
  std::map<db::RowId, std::vector<db::RowId>> bound_;  // calibrations of each frame
  std::string common_, print_before_, first_left_;
};

}  // namespace

RunReflectanceOutcome fitRun(const fs::path& archive, const RunReflectanceRequest& request,
                             UtcTime now, Progress& progress) {
  return RunFit(archive, request, progress).run(now);
}

}  // namespace patina::workflow
