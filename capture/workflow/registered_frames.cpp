// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/registered_frames.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "calibration/registration/fiducials.h"
#include "capture/workflow/facts.h"

namespace patina::workflow {

using namespace calibration;

namespace {

// What of the first frame this one sees too, by its pose: the largest upright rectangle within its
// four edges, a pixel left off.
RectPx seenBy(const Motion& frame_from_reference, SizePx size) {
  const Motion back = inverse(frame_from_reference);
  const double right = size.width - 1, low = size.height - 1;
  const PlacePx a = moved(back, {0, 0}), b = moved(back, {right, 0}), c = moved(back, {right, low}),
                d = moved(back, {0, low});
  const int x0 = static_cast<int>(std::ceil(std::max({a.x, d.x, 0.0}))),
            y0 = static_cast<int>(std::ceil(std::max({a.y, b.y, 0.0}))),
            x1 = static_cast<int>(std::floor(std::min({b.x, c.x, right}))) + 1,
            y1 = static_cast<int>(std::floor(std::min({c.y, d.y, low}))) + 1;
  return {x0, y0, std::max(x1 - x0, 0), std::max(y1 - y0, 0)};
}

RectPx common(const RectPx& a, const RectPx& b) {
  const int x = std::max(a.x, b.x), y = std::max(a.y, b.y);
  return {x, y, std::max(std::min(a.x + a.width, b.x + b.width) - x, 0),
          std::max(std::min(a.y + a.height, b.y + b.height) - y, 0)};
}

Facts factsOf(const RegisteredFrame& one) {
  Facts facts;
  facts.count("frame", one.pose.frame).number("time_s", one.time_s);
  facts.text("source_sha256", one.source.hex());
  facts.text("verdict", name(one.pose.verdict)).set("used", one.used);
  if (!one.pose.reason.empty()) facts.text("reason", one.pose.reason);
  facts.count("epoch", one.pose.epoch).number("agreeing_share", one.pose.share);
  facts.number("uncertainty_px", std::min(one.pose.uncertainty_px, 1e6));
  facts.number("contrast", one.pose.contrast).number("sharpness", one.pose.sharpness);
  if (one.deformed_px > 0) facts.number("deformed_px", one.deformed_px);
  for (std::size_t k = 0; k < 9; ++k)
    facts.number("m" + std::to_string(k / 3) + std::to_string(k % 3),
                 one.pose.frame_from_reference[k]);
  return facts;
}

}  // namespace

Image<std::uint8_t> outsideOf(const RegistrationRequest& request, const Image<float>& first) {
  if (request.fiducials.empty() && !request.markers) return {};
  Image<std::uint8_t> outside = maskOf(request.fiducials, first.size());
  if (!request.markers) return outside;
  const Image<std::uint8_t> markers = markersIn(first.view());
  for (std::size_t k = 0; k < markers.texels().size(); ++k)
    outside.texels()[k] |= markers.texels()[k];
  return outside;
}

RegisteredFrames::RegisteredFrames(ttf::FrameSource& frames, const RegistrationRequest& request,
                                   std::optional<PixelMap> map, Progress& progress)
    : frames_(frames), request_(request), map_(std::move(map)), progress_(progress) {}

void RegisteredFrames::begin(const Image<float>& first) {
  TrackOptions options;
  options.keys.align.model = request_.model;
  options.outside = outsideOf(request_, first);
  if (request_.deform) {
    DeformationTrackOptions fields;
    fields.specimen = options.outside;
    for (std::uint8_t& mark : fields.specimen.texels()) mark = mark == 0 ? 255 : 0;
    deformations_ = std::make_unique<DeformationTrack>(std::move(fields));
  }
  track_ = std::make_unique<PoseTrack>(std::move(options));
  report_.seen_by_all = {0, 0, first.width(), first.height()};
}

PixelMap RegisteredFrames::placesOf(const Image<float>& frame, RegisteredFrame& about) {
  const Motion& pose = about.pose.frame_from_reference;
  if (!request_.deform) {
    const PixelMap whole = map_ ? *map_ : identityMap({0, 0, frame.width(), frame.height()});
    return composed(whole, pose);
  }
  const Deformation field = deformations_->add(frame.view(), pose, progress_);
  about.deformed_px = field.largest_px;
  return map_ ? composed(*map_, field.map()) : field.map();
}

std::optional<ttf::SourceFrame> RegisteredFrames::next() {
  while (std::optional<ttf::SourceFrame> frame = frames_.next()) {
    if (!track_) begin(frame->linear);
    RegisteredFrame about;
    about.time_s = frame->time_s;
    about.source = frame->source;
    about.pose = track_->add(std::as_const(frame->linear).view(), progress_);
    about.used = isTrusted(about.pose.verdict);
    report_.epochs = track_->epochs();
    report_.keyframes = track_->keyframesMade();
    if (!about.used) {
      ++report_.refused;
      report_.frames.push_back(about);
      continue;
    }
    const SizePx size = frame->linear.size();
    const Motion& pose = about.pose.frame_from_reference;
    const bool stays = pose == kNoMotion && !map_ && !request_.deform;
    if (!stays)
      frame->linear = resample(std::as_const(frame->linear).view(), placesOf(frame->linear, about));
    report_.seen_by_all = common(report_.seen_by_all, seenBy(pose, size));
    report_.largest_move_px =
        std::max(report_.largest_move_px, cornersApart(pose, kNoMotion, size));
    report_.frames.push_back(about);
    return frame;
  }
  return std::nullopt;
}

std::string registrationLines(const RegistrationReport& report,
                              const RegistrationRequest& request) {
  Facts head;
  head.text("schema", "patina.registration/1").text("model", name(request.model));
  head.count("frames", static_cast<std::int64_t>(report.frames.size()));
  head.count("refused", report.refused).count("keyframes", report.keyframes);
  std::vector<std::string> epochs;
  for (const PoseEpoch& epoch : report.epochs)
    epochs.push_back(
        "frame " + std::to_string(epoch.first_frame) + ": " + name(epoch.cause) +
        (epoch.cause == EpochCause::kStart ? "" : ", " + std::to_string(epoch.jump_px) + " px"));
  head.set("epochs", epochs);
  const RectPx& r = report.seen_by_all;
  head.text("seen_by_all", std::to_string(r.x) + "," + std::to_string(r.y) + "," +
                               std::to_string(r.width) + "," + std::to_string(r.height));
  std::string lines = head.json() + "\n";
  for (const RegisteredFrame& frame : report.frames) {
    lines += factsOf(frame).json();
    lines += "\n";
  }
  return lines;
}

std::string refusedFrames(const RegistrationReport& report) {
  if (report.refused == 0) return "";
  std::string text = std::to_string(report.refused) + " of " +
                     std::to_string(report.frames.size()) + " frames refused:";
  constexpr int kNamed = 20;
  int named = 0;
  for (const RegisteredFrame& frame : report.frames) {
    if (frame.used) continue;
    if (++named > kNamed) return text + " ...";
    text += (named > 1 ? ", " : " ") + std::to_string(frame.pose.frame);
    text.append(" (").append(name(frame.pose.verdict)).append(": ");
    text.append(frame.pose.reason).append(")");
  }
  return text;
}

}  // namespace patina::workflow
