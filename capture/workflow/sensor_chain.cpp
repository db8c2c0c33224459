// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sensor_chain.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "calibration/sensor/merge.h"
#include "capture/workflow/calibration_record.h"
#include "capture/workflow/defects_calibration.h"
#include "capture/workflow/failure.h"
#include "capture/workflow/photon_transfer_calibration.h"
#include "capture/workflow/response_calibration.h"
#include "processing/image/encoding.h"
#include "processing/image/linear_mosaic.h"

namespace patina::workflow {
namespace {

using calibration::CalibrationDistance;
using calibration::CalibrationKey;

constexpr float kWhite = 0.985f;  // linear; the code before the last of 8 bits

struct Match {
  const db::CalibrationRow* row = nullptr;
  CalibrationDistance distance;
};

std::string nameOf(const db::CalibrationRow& row) {
  return row.kind + " " + std::to_string(row.id);
}

std::string described(const Match& match) {
  char text[160];
  std::snprintf(text, sizeof text, "%s: %.1f days, %.1f K away", nameOf(*match.row).c_str(),
                match.distance.time_s / 86400, match.distance.temperature_k);
  return text;
}

void noteOnce(std::vector<std::string>& list, const std::string& text) {
  if (std::find(list.begin(), list.end(), text) == list.end()) list.push_back(text);
}

bool isMaster(const std::string& kind) {
  return kind == "dark" || kind == "bias" || kind == "flat" || kind == "dark_flat";
}

// Why a row does not serve pictures of so many channels, linear by this response.
std::string otherMaking(const db::CalibrationRow& row, int channels, db::RowId response) {
  if (!isMaster(row.kind)) return {};
  const Facts values = Facts::parse(row.value_json);
  if (channels != 0 && values.number("channels").value_or(channels) != channels)
    return channels == 1 ? "made of pictures in colour, not of the raw mosaic"
                         : "made of a raw mosaic, not of pictures in colour";
  if (static_cast<db::RowId>(values.number("response").value_or(0)) != response)
    return "made by another response";
  return {};
}

// The nearest in time of those that are best within tolerance; of equals the newest row.
bool isNearer(const CalibrationDistance& a, const CalibrationDistance& b) {
  return std::pair(!a.within_tolerance, a.time_s) <= std::pair(!b.within_tolerance, b.time_s);
}

bool isRaw(PictureFormat format) {
  return format == PictureFormat::kDng || format == PictureFormat::kRaw;
}

// Where a developed file has reached white.
Image<std::uint8_t> whitesOf(const Image<float>& linear) {
  Image<std::uint8_t> marks(linear.width(), linear.height(), linear.channels());
  std::transform(linear.texels().begin(), linear.texels().end(), marks.texels().begin(),
                 [](float v) -> std::uint8_t { return v >= kWhite ? calibration::kSaturated : 0; });
  return marks;
}

// Of a JPEG or an 8-bit PNG or TIFF; what sRGB says is undone to the code it came from.
Image<float> linearByResponse(const Image<float>& linear,
                              const calibration::ResponseCurve& response) {
  const Image<std::uint8_t> codes = encodeSrgb8(linear.view());
  return calibration::linearBy(response, codes.view());
}

}  // namespace

SensorPicture decodeSensorPicture(std::span<const std::byte> file,
                                  const calibration::ResponseCurve* response) {
  SensorPicture out;
  if (isRaw(sniffFormat(file))) {
    out.raw = decodeRaw(file);
    out.bits = std::bit_width(static_cast<unsigned>(out.raw->white_level));
    return out;
  }
  Picture picture = decodePicture(file);
  out.bits = picture.bits;
  out.linear = response != nullptr && picture.bits == 8
                   ? linearByResponse(picture.linear, *response)
                   : std::move(picture.linear);
  return out;
}

Image<float> uncorrected(const SensorPicture& picture) {
  if (!picture.raw) return picture.linear;
  const SizePx size = picture.raw->samples.size();
  Image<float> light(size.width, size.height, 1);
  calibration::toRadiance(*picture.raw,
                          calibration::prepareCorrection(size, 1, picture.raw->cfa, {}, {}, {}),
                          {1, 1, 1}, light.view());
  return light;
}

CalibrationKey keyOf(const db::ShotRow& shot, const db::FrameRow& frame) {
  CalibrationKey key;
  key.device_id = shot.device_id;
  key.exposure = shot.exposure;
  key.iso = shot.iso;
  key.size = frame.size;
  key.utc = frame.utc;
  key.light_state = shot.light_state;
  return key;
}

CalibrationKey keyOf(const db::CalibrationRow& row) {
  CalibrationKey key{row.kind, row.device_id,     row.exposure, row.iso,
                     row.size, row.temperature_c, row.utc,      row.light_state};
  const Facts values = Facts::parse(row.value_json);
  key.bits = static_cast<int>(values.number("bits").value_or(0));
  key.focal_mm = values.number("focal_mm").value_or(0);
  key.focus_m = values.number("focus_m").value_or(0);
  return key;
}

std::optional<db::CalibrationRow> nearestCalibration(const db::ArchiveReader& reader,
                                                     const std::string& kind,
                                                     const CalibrationKey& key, int channels,
                                                     db::RowId response) {
  std::optional<db::CalibrationRow> best;
  CalibrationDistance best_distance;
  for (db::CalibrationRow& row : reader.calibrations(kind)) {
    const CalibrationDistance distance = calibration::distanceBetween(key, keyOf(row));
    if (!distance.within_tolerance || !otherMaking(row, channels, response).empty()) continue;
    if (best && !isNearer(distance, best_distance)) continue;
    best = std::move(row);
    best_distance = distance;
  }
  return best;
}

SensorChain::SensorChain(const db::ArchiveReader& reader, std::span<const std::byte> sample,
                         bool stale)
    : reader_(reader), stale_(stale), rows_(reader.calibrations()) {
  const SensorPicture picture = decodeSensorPicture(sample, nullptr);
  mosaic_ = picture.raw.has_value();
  bits_ = picture.bits;
  channels_ = mosaic_ ? 1 : picture.linear.channels();
  if (mosaic_) filters_ = picture.raw->cfa;
}

const db::CalibrationRow& SensorChain::row(db::RowId id) const {
  return *std::find_if(rows_.begin(), rows_.end(), [&](const auto& r) { return r.id == id; });
}

std::optional<db::RowId> SensorChain::choose(const std::string& kind, const CalibrationKey& key,
                                             db::RowId frame_id,
                                             std::optional<db::RowId> response) {
  Match best;
  std::string why_not;
  const auto leave = [&](const db::CalibrationRow& r, const std::string& why) {
    why_not = nameOf(r) + ": " + why + "; " + calibration::shootInstead(key, kind);
  };
  for (const db::CalibrationRow& r : rows_) {
    if (r.kind != kind) continue;
    const CalibrationDistance distance = calibration::distanceBetween(key, keyOf(r));
    const std::string why =
        distance.usable ? otherMaking(r, channels_, response.value_or(0)) : distance.why_not;
    if (!why.empty())
      leave(r, why);
    else if (best.row == nullptr || isNearer(distance, best.distance))
      best = {&r, distance};
  }
  if (best.row == nullptr) {
    if (!why_not.empty()) noteOnce(report_.left, why_not);
    return std::nullopt;
  }
  if (!best.distance.within_tolerance && !stale_) {
    leave(*best.row, best.distance.why_not);
    noteOnce(report_.left, why_not + "; or use it all the same by --stale-calibration");
    return std::nullopt;
  }
  if (told_.insert(best.row->id).second) {
    report_.used.push_back(described(best));
    report_.input_sha256s.push_back(best.row->sha256);
  }
  bindings_.push_back({frame_id, best.row->id, best.distance.time_s, best.distance.temperature_k,
                       best.distance.within_tolerance});
  return best.row->id;
}

std::size_t SensorChain::bind(CalibrationKey key, db::RowId frame_id) {
  key.bits = bits_;
  Chosen chosen;
  std::optional<db::RowId> response;
  const auto use = [&](const char* kind) {
    const std::optional<db::RowId> id = choose(kind, key, frame_id, response);
    if (id) chosen[kind] = *id;
    return id;
  };
  if (!mosaic_ && bits_ == 8) response = use("response");
  if (!use("dark")) use("bias");
  use("defects");
  use("flat");
  if (const auto id = use("photon_transfer"); id && !noise_)
    noise_ = readNoise(fileOfCalibration(reader_, row(*id)));
  const auto same = std::find_if(ready_.begin(), ready_.end(), [&](const Ready& r) {
    return r.chosen == chosen && r.size == key.size && r.exposure == key.exposure;
  });
  const auto index = static_cast<std::size_t>(same - ready_.begin());
  if (same == ready_.end()) {
    ready_.emplace_back();
    ready_.back().chosen = chosen;
    ready_.back().size = key.size;
    ready_.back().exposure = key.exposure;
  }
  ready_[index].warmest_c = std::max(ready_[index].warmest_c, key.temperature_c);
  return index;
}

void SensorChain::prepare() {
  for (Ready& ready : ready_) prepare(ready, false);
}

void SensorChain::prepareToMerge() {
  for (Ready& ready : ready_) prepare(ready, true);
}

void SensorChain::prepare(Ready& ready, bool flat_apart) const {
  const auto picture =
      [&](std::initializer_list<const char*> kinds) -> std::optional<Image<float>> {
    for (const char* kind : kinds)
      if (const auto at = ready.chosen.find(kind); at != ready.chosen.end())
        return readPicture(fileOfCalibration(reader_, row(at->second))).linear;
    return std::nullopt;
  };
  const auto view = [](const std::optional<Image<float>>& image) {
    return image ? std::optional<ImageView<const float>>(image->view()) : std::nullopt;
  };
  const std::optional<Image<float>> dark = picture({"dark", "bias"}), flat = picture({"flat"});
  std::vector<calibration::Defect> defects;
  if (const auto at = ready.chosen.find("defects"); at != ready.chosen.end())
    defects = calibration::defectsThatMatter(
        readDefects(fileOfCalibration(reader_, row(at->second))), ready.exposure, ready.warmest_c);
  ready.correction = calibration::prepareCorrection(
      ready.size, channels_, filters_, view(dark), flat_apart ? std::nullopt : view(flat), defects);
  if (flat_apart)
    ready.flat =
        calibration::prepareCorrection(ready.size, channels_, filters_, {}, view(flat), {});
  if (const auto at = ready.chosen.find("response"); at != ready.chosen.end())
    ready.response = readResponse(fileOfCalibration(reader_, row(at->second)));
}

void forgetWhites(Image<float>& linear) {
  for (float& v : linear.texels())
    if (v >= kWhite) v = std::numeric_limits<float>::quiet_NaN();
}

Image<float> SensorChain::apply(std::size_t bound, std::span<const std::byte> file,
                                const calibration::ChannelGains& gain) const {
  return apply(bound, file, gain, nullptr);
}

Image<float> SensorChain::applyWhereKnown(std::size_t bound, std::span<const std::byte> file,
                                          const calibration::ChannelGains& gain) const {
  Image<std::uint8_t> marks;
  Image<float> light = apply(bound, file, gain, &marks);
  forgetClipped(light, marks);
  return light;
}

void SensorChain::forgetClipped(Image<float>& light, const Image<std::uint8_t>& marks) const {
  const int reach = mosaic_ ? 1 : 0;  // a colour is mixed from the pixels around
  for (int y = 0; y < marks.height(); ++y)
    for (int x = 0; x < marks.width(); ++x) {
      const auto own = marks.view().texel(x, y);
      if (std::ranges::none_of(own, [](auto m) { return (m & calibration::kSaturated) != 0; }))
        continue;
      for (int v = std::max(0, y - reach); v <= std::min(light.height() - 1, y + reach); ++v)
        for (int u = std::max(0, x - reach); u <= std::min(light.width() - 1, x + reach); ++u)
          std::ranges::fill(light.view().texel(u, v), std::numeric_limits<float>::quiet_NaN());
    }
}

Image<float> SensorChain::apply(std::size_t bound, std::span<const std::byte> file,
                                const calibration::ChannelGains& gain,
                                Image<std::uint8_t>* marks) const {
  const Ready& ready = ready_.at(bound);
  SensorPicture picture = decodeSensorPicture(file, ready.response ? &*ready.response : nullptr);
  if (!picture.raw) {
    if (marks) *marks = whitesOf(picture.linear);
    calibration::correctLinear(picture.linear.view(), ready.correction, gain);
    return std::move(picture.linear);
  }
  Image<float> light(ready.size.width, ready.size.height, 1);
  if (marks) *marks = Image<std::uint8_t>(ready.size.width, ready.size.height, 1);
  calibration::toRadiance(*picture.raw, ready.correction, gain, light.view(),
                          marks ? marks->view() : ImageView<std::uint8_t>{});
  return demosaicLinear(std::as_const(light).view(), ready.correction.filters);
}

calibration::NoiseModels SensorChain::noiseOrPhotons() const {
  if (noise_) return *noise_;
  calibration::NoiseModels photons;
  photons.fill({.white_level = static_cast<double>((1 << std::min(bits_, 16)) - 1)});
  return photons;
}

SensorChain::Merged SensorChain::merge(std::span<const Exposure> exposures) const {
  return merge(exposures, nullptr);
}

SensorChain::Merged SensorChain::mergeWhereKnown(std::span<const Exposure> exposures) const {
  Image<std::uint8_t> marks;
  Merged merged = merge(exposures, &marks);
  forgetClipped(merged.light, marks);
  return merged;
}

SensorChain::Merged SensorChain::merge(std::span<const Exposure> exposures,
                                       Image<std::uint8_t>* of_merged) const {
  calibration::ChannelGains mean{};
  for (const Exposure& one : exposures)
    for (std::size_t c = 0; c < 3; ++c)
      mean[c] += one.gain[c] / static_cast<float>(exposures.size());
  std::vector<Image<float>> lights;
  std::vector<Image<std::uint8_t>> marks;
  for (const Exposure& one : exposures) {
    const Ready& ready = ready_.at(one.bound);
    calibration::ChannelGains apart{};
    for (std::size_t c = 0; c < 3; ++c) apart[c] = one.gain[c] / mean[c];
    SensorPicture picture =
        decodeSensorPicture(one.file, ready.response ? &*ready.response : nullptr);
    if (picture.raw) {
      lights.emplace_back(ready.size.width, ready.size.height, 1);
      marks.emplace_back(ready.size.width, ready.size.height, 1);
      calibration::toRadiance(*picture.raw, ready.correction, apart, lights.back().view(),
                              marks.back().view());
      continue;
    }
    marks.push_back(whitesOf(picture.linear));
    calibration::correctLinear(picture.linear.view(), ready.correction, apart);
    lights.push_back(std::move(picture.linear));
  }
  std::vector<calibration::Exposed> exposed;
  double shortest_s = exposures.front().seconds;
  for (std::size_t i = 0; i < exposures.size(); ++i) {
    exposed.push_back({lights[i].view(), marks[i].view(), exposures[i].seconds});
    shortest_s = std::min(shortest_s, exposures[i].seconds);
  }
  calibration::Merged merged = calibration::mergeExposures(exposed, filters_, noiseOrPhotons());
  for (float& v : merged.light.texels()) v *= static_cast<float>(shortest_s);
  calibration::correctLinear(merged.light.view(), *ready_.at(exposures.front().bound).flat, mean);
  const std::vector<std::uint8_t>& of_all = merged.marks.texels();
  for (std::size_t i = 0; i < of_all.size(); ++i)
    if ((of_all[i] & calibration::kSaturated) != 0)
      merged.light.texels()[i] = std::max(merged.light.texels()[i], 1.0f);
  Merged out{{}, merged.saturated, merged.disagreement};
  out.light = mosaic_ ? demosaicLinear(std::as_const(merged.light).view(), filters_)
                      : std::move(merged.light);
  if (of_merged) *of_merged = std::move(merged.marks);
  return out;
}

}  // namespace patina::workflow
