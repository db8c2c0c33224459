// SPDX-License-Identifier: GPL-3.0-or-later
// The picture's vote on its own light. See light_gate.h.
#include <algorithm>
#include <cmath>

#include "capture/light_gate.h"
#include "capture/recall.h"
#include "capture/witness_drift.h"

namespace patina::capture {

using calibration::LightVerdict;

namespace {

constexpr double kSharp = 5;  // deviations of the picture's light that tell it from the patch
constexpr double kSpots = 0.02;
constexpr double kStillSoiled = 0.5;  // of what the patch was covered by

std::string wholePercent(double share) { return std::to_string(std::lround(share * 100)) + " %"; }

}  // namespace

void LightGate::restorePicture(const RecalledPicture& picture) {
  if (!picture.tiles || picture.light_state == "off" || check_.mode == LightMode::kUncontrolled)
    return;
  const Key key{picture.light_state, picture.camera, "tiles", picture.exposure_index};
  calibration::takeIn(contents_[key], *picture.tiles, picture.patch, picture.utc, content_options_);
}

std::vector<LightGate::Content> LightGate::judgeContents(const LightSample& sample) {
  std::vector<Content> contents;
  if (check_.mode == LightMode::kUncontrolled) return contents;
  for (const ContentSample& one : sample.contents) {
    const Key key{sample.light_state, one.camera, "tiles", sample.exposure_index};
    Content c;
    c.sample = &one;
    c.series = &contents_[key];
    c.judgement = calibration::judgeContent(*c.series, one.tiles, sample.utc, content_options_);
    contents.push_back(c);
  }
  return contents;
}

// The patch moved, or has moved and stays so, and the picture did not, nor did a lux sensor.
bool LightGate::isSoiled(const Witness& patch, const Content& content, const Witness* lux) {
  if (!content.judgement.quiet || patch.channels.empty() || !patch.known) return false;
  const double common = content.judgement.common;
  bool moved = patch.bad;
  for (const Judged& j : patch.channels) {
    if (!j.watched) return false;
    const double soiled = j.watched->soiled;
    moved = moved || j.chart.signal == calibration::ChartSignal::kStep ||
            (soiled != 0 && j.deviation / soiled > kStillSoiled);
  }
  if (!moved) return false;
  // Of all channels: a lamp of another colour is no dirt. Spots do not move the level by much:
  // there the picture's light must be as it was.
  double away = 0;
  for (const Judged& j : patch.channels)
    away += j.deviation / static_cast<double>(patch.channels.size());
  if (patch.covered) away = std::max(std::abs(away), kSpots);
  const auto quiet = [&](double deviation) { return std::abs(deviation) < std::abs(away) / 3; };
  if (std::abs(common - away) < kSharp * content.judgement.common_noise || !quiet(common))
    return false;
  return lux == nullptr || quiet(lux->deviation);
}

void LightGate::cover(Witness& w, const LightSample& sample, GateVerdict& out) const {
  for (std::size_t c = 0; c < w.channels.size(); ++c) {
    Judged& j = w.channels[c];
    db::LightCheckRow& row = out.rows[w.first_row + c];
    row.verdict = calibration::name(LightVerdict::kCovered);
    row.gain = j.watched->series.baseline > 0
                   ? j.watched->series.baseline / j.watched->series.forecast
                   : 1;
    j.watched->soiled = j.deviation;
    j.watched->chart.last_utc = sample.utc;  // looked at, and not believed
    j.watched = nullptr;
  }
  w.bad = w.covered = false;
  out.reason.clear();
  blame(out, LightVerdict::kCovered, false,
        "light " + sample.light_state + ": " + w.source + " (" + percent(w.deviation) +
            ") is soiled or covered: the picture says light; its gain stays as it was");
}

void LightGate::judgePicture(const Content& content, const Witness& patch,
                             const LightSample& sample, GateVerdict& out) const {
  const calibration::ContentJudgement& j = content.judgement;
  const std::string source = "content:" + content.sample->camera;
  db::LightCheckRow r = row(sample, source, "tiles", 1 + j.common);
  r.shot_id = content.sample->shot_id;
  r.baseline = 1;
  r.ratio = r.level;
  r.verdict = calibration::name(LightVerdict::kPass);
  const auto tell = [&](LightVerdict verdict, bool blocks, const std::string& text) {
    r.verdict = calibration::name(verdict);
    blame(out, verdict, blocks, "light " + sample.light_state + ": " + source + " " + text);
  };
  for (const auto& [key, other] : contents_) {
    if (key.light_state == sample.light_state || key.source != content.sample->camera ||
        key.exposure_index != sample.exposure_index)
      continue;
    if (!patch.bad &&
        calibration::hasLightOf(other, *content.series, content.sample->tiles, content_options_)) {
      tell(LightVerdict::kHold, true,
           "has the shading of " + key.light_state + ": is the wrong lamp lit?");
      break;
    }
  }
  const double apart = j.common - patch.deviation;
  const double most = std::max(check_.band, kSharp * j.common_noise);
  if (r.verdict == "pass" && !patch.bad && patch.known) {
    if (std::abs(apart) > most)
      tell(LightVerdict::kAtOdds, false,
           "changed by " + percent(apart) + " and the patch did not: fog, a hand, a moved camera?");
    else if (j.moved)
      tell(LightVerdict::kAtOdds, false,
           wholePercent(j.moved_share) + " of it changed by " + percent(j.local) +
               " and the patch did not: a shadow, a visitor, or the specimen moved?");
  }
  out.rows.push_back(std::move(r));
}

void LightGate::askContent(std::vector<Content>& contents, std::vector<Witness>& witnesses,
                           const LightSample& sample, GateVerdict& out) const {
  const auto lux = std::find_if(witnesses.begin(), witnesses.end(), [](const Witness& w) {
    return w.source.starts_with("sensor:") && w.known;
  });
  for (Content& content : contents) {
    const auto patch = std::find_if(witnesses.begin(), witnesses.end(), [&](const Witness& w) {
      return w.source == "patch:" + content.sample->camera;
    });
    if (patch == witnesses.end()) continue;
    content.patch = patch->known ? patch->deviation : 0;
    if (!content.judgement.known) continue;
    if (isSoiled(*patch, content, lux == witnesses.end() ? nullptr : &*lux)) {
      cover(*patch, sample, out);
      content.patch = 0;
      patch->deviation = 0;
    } else if (patch->bad && std::abs(content.judgement.common - patch->deviation) <
                                 std::abs(patch->deviation) / 3) {
      patch->remark = ", and the whole picture with it";
    }
    judgePicture(content, *patch, sample, out);
  }
}

}  // namespace patina::capture
