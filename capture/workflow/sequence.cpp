// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sequence.h"

#include <algorithm>

#include "capture/workflow/facts.h"
#include "capture/workflow/failure.h"
#include "processing/image/encoding.h"

namespace patina::workflow {
namespace {

class TtfFrames final : public ttf::FrameSource {
 public:
  TtfFrames(std::shared_ptr<ttf::TtfReader> reader, int every)
      : reader_(std::move(reader)), every_(every) {}
  std::int64_t count() const override { return (reader_->info().frames + every_ - 1) / every_; }
  std::optional<ttf::SourceFrame> next() override {
    const ttf::TtfInfo& info = reader_->info();
    if (next_ >= info.frames) return std::nullopt;
    const auto t = static_cast<std::size_t>(next_);
    ttf::SourceFrame frame{info.time_s[t], info.source[t], reader_->linearFrame(next_)};
    next_ += every_;
    return frame;
  }

 private:
  std::shared_ptr<ttf::TtfReader> reader_;
  const int every_;
  int next_ = 0;
};

constexpr double kShareBelow = 0.995, kTarget = 0.9;

}  // namespace

Sequence sequenceOfTtf(const std::filesystem::path& file) {
  auto reader = std::make_shared<ttf::TtfReader>(file);
  Sequence sequence;
  sequence.name = file.filename().string();
  sequence.frames = reader->info().frames;
  sequence.size = {reader->info().width, reader->info().height};
  sequence.t0_utc = reader->info().t0_utc;
  sequence.display_referred = isDisplayReferred(reader->info());
  sequence.input_sha256s = {sha256OfFile(file).hex()};
  sequence.open = [reader](int every) { return std::make_unique<TtfFrames>(reader, every); };
  return sequence;
}

Sequence sequenceOfRun(std::shared_ptr<const db::ArchiveReader> reader, const std::string& run_id,
                       const FrameSelection& selection, const Correction& correction) {
  const ArchiveFrames frames(*reader, run_id, selection, correction);
  Sequence sequence;
  sequence.name = run_id;
  sequence.frames = frames.count();
  sequence.size = frames.report().size;
  sequence.t0_utc = reader->findRun(run_id).t0_utc;
  sequence.display_referred = frames.report().display_referred;
  sequence.input_sha256s = frames.report().input_sha256s;
  sequence.open = [=](int every) {
    FrameSelection thinned = selection;
    thinned.every *= every;
    return std::make_unique<ArchiveFrames>(*reader, run_id, thinned, correction);
  };
  return sequence;
}

bool isDisplayReferred(const ttf::TtfInfo& info) {
  try {
    return Facts::parse(info.provenance_json).flag("options.display_referred");
  } catch (const WorkflowError&) {
    return false;  // another program's file may say of itself what it likes
  }
}

double displayGain(const Sequence& sequence, Progress& progress) {
  if (sequence.display_referred) return 1;
  const auto source =
      sequence.open(static_cast<int>(std::max<std::int64_t>(1, sequence.frames / 9)));
  progress.begin("looking at the exposure", source->count());
  std::vector<float> samples;
  while (auto frame = source->next()) {
    const std::vector<float>& texels = frame->linear.texels();
    const std::size_t stride = std::max<std::size_t>(1, texels.size() / 30'011);
    for (std::size_t i = 0; i < texels.size(); i += stride) samples.push_back(texels[i]);
    progress.step();
  }
  if (samples.empty()) return 1;
  const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(
                                         kShareBelow * static_cast<double>(samples.size() - 1));
  std::nth_element(samples.begin(), nth, samples.end());
  const double bright = *nth;
  return bright > 1e-6 ? kTarget / bright : 1;
}

Image<std::uint8_t> toDisplay(ImageView<const float> linear, double gain) {
  Image<float> shown(linear.width, linear.height, 3);
  for (int y = 0; y < linear.height; ++y) {
    const float* from = linear.row(y);
    float* to = shown.view().row(y);
    for (int x = 0; x < linear.width; ++x)
      for (int c = 0; c < 3; ++c)
        to[3 * x + c] =
            static_cast<float>(gain * from[linear.channels * x + (linear.channels == 3 ? c : 0)]);
  }
  return encodeSrgb8(ImageView<const float>(shown.view()));
}

}  // namespace patina::workflow
