// SPDX-License-Identifier: GPL-3.0-or-later
// Whether the light of a shot is the light of the run: calibration judges levels, this decides.
//
// The level is judged at every shot, never an edge, so nothing is missed between looks. A shot that
// blocks changes no series. Two witnesses (patch and lux sensor) that disagree are at odds, and the
// one that moved is named.
//
// What the first shots see is taken for the light of the run, so a lamp that changes among them is
// told of whatever it does. Before there is a baseline (three steady levels) a step is named and
// the shot is taken: nobody knows which level is the right one. After it, until ten levels have
// agreed, the baseline is provisional: a step is held as always, but when it lasts for ten tries
// and is no larger than a drift may be, the baseline is learned anew and the run goes on, since a
// fault that ended there would hold it for ever. When the light then goes back to what was learned
// first, before the new baseline is firm, the first one holds again. All come out as `changed`.
//
// Below the band, charts (calibration/light/charts.h) tell a cause from common drift: a step is
// told of and followed by the gain. The picture's own tiles (content.h) vote with patch and sensor:
//   patch alone moved                 soiled: `covered`, shot, its gain stays as it was
//   part of the picture, patch not    a shadow or a visitor: shot, the frame is marked `at_odds`
//   all of them                       the lamp: corrected within the band, held beyond it
//   lux sensor alone                  stuck: marked `at_odds`
//   shading of another light state    the wrong lamp is lit: held
// After a restart the tiles are those of the run's last frames: content votes from the first shot.
//
// A patch whose camera was away may be judged by what the lux sensor has followed since.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibration/light/charts.h"
#include "calibration/light/content.h"
#include "calibration/light/light_statistics.h"
#include "capture/light_evidence.h"
#include "capture/plan.h"
#include "db/rows.h"
#include "devices/rig.h"

namespace patina::capture {

struct RecalledPicture;  // recall.h

class LightGate {
 public:
  LightGate(const LightCheck& check, const std::vector<devices::SensorSpec>& sensors,
            std::string run_id);

  // The series as the rows of an earlier process left them; in order of time, the last few of
  // each series are enough.
  void restore(std::span<const db::LightCheckRow> rows);
  void restorePicture(const RecalledPicture& picture);  // in order of time
  // Lamps off: exempt, no rows; a sensor with an absolute band still counts.
  GateVerdict judge(const LightSample& sample);
  // The other light state whose light all patches of these rows see: "fill"; empty if none.
  std::string lightLike(std::span<const db::LightCheckRow> rows) const;

 private:
  struct Key {
    std::string light_state, source, channel;
    int exposure_index = 0;
    auto operator<=>(const Key&) const = default;
  };
  struct Watched {
    calibration::LightSeries series;
    double spread = -1;           // of the patch while all was well; below 0: not known yet
    std::vector<double> refused;  // in a row, against a provisional baseline
    std::optional<calibration::LightSeries> former;  // that a provisional one was learned over
    double unseen = 1;  // what the lux sensor's forecast was multiplied by since this looked last
    calibration::ControlChart chart;
    std::array<calibration::ControlChart, 2> colour;  // u', v'; of a patch's first channel
    double banding = 0;                               // of the patch, while all was well
    double soiled = 0;                                // deviation it is covered by; 0: clean
  };
  struct Judged {  // one channel, before it is known whether the shot blocks
    Watched* watched = nullptr;
    Watched after;
    calibration::LightJudgement judgement;
    calibration::ChartJudgement chart;
    double deviation = 0;  // of the level from the forecast
    double noise = 0;      // of the level, relative
    bool known = false;    // there was a baseline to deviate from
  };
  struct Former {
    calibration::LightSeries series;
    calibration::LightJudgement judgement;
  };
  struct Witness {  // one patch or one lux sensor
    std::string source;
    std::vector<Judged> channels;
    std::size_t first_row = 0;
    double deviation = 0;  // of the worst channel
    bool known = false, bad = false, covered = false;
    std::string remark;  // what the picture says to it
  };
  struct Content {  // of one camera's picture
    const ContentSample* sample = nullptr;
    calibration::ContentSeries* series = nullptr;
    calibration::ContentJudgement judgement;
    double patch = 0;  // deviation of the patch in it
  };

  Witness judgePatch(const LightSample& sample, const PatchSample& patch, GateVerdict& out);
  Witness judgeLux(const LightSample& sample, const SensorSample& lux, GateVerdict& out);
  void judgeBand(const LightSample& sample, const SensorSample& sensor, GateVerdict& out) const;
  Judged judgeChannel(const LightSample& sample, const std::string& source,
                      const std::string& channel, double level, double noise, GateVerdict& out);
  void judgeSeries(Judged& judged, double level, UtcTime utc) const;
  void chartColour(Witness& witness, const PatchSample& patch, const LightSample& sample,
                   GateVerdict& out) const;
  void tellCauses(const std::vector<Witness>& witnesses, const LightSample& sample,
                  GateVerdict& out) const;
  std::vector<Content> judgeContents(const LightSample& sample);
  void askContent(std::vector<Content>& contents, std::vector<Witness>& witnesses,
                  const LightSample& sample, GateVerdict& out) const;
  static bool isSoiled(const Witness& patch, const Content& content, const Witness* lux);
  void cover(Witness& patch, const LightSample& sample, GateVerdict& out) const;
  void judgePicture(const Content& content, const Witness& patch, const LightSample& sample,
                    GateVerdict& out) const;
  void compare(std::vector<Witness>& witnesses, const LightSample& sample, GateVerdict& out) const;
  bool contradicts(const Witness& witness, const GateVerdict& out) const;
  void doubt(std::vector<Witness>& witnesses, const GateVerdict& out) const;
  void learnAnew(std::vector<Witness>& witnesses, const LightSample& sample,
                 GateVerdict& out) const;
  bool takeBack(std::vector<Witness>& witnesses, const LightSample& sample, GateVerdict& out) const;
  static void remember(Watched& watched, double baseline);
  void follow(const db::LightCheckRow& lux, double change);
  void takeIn(std::vector<Witness>& witnesses, const GateVerdict& out);
  std::string summaryOf(const Judged& judged, const db::LightCheckRow& row,
                        const GateVerdict& out) const;
  db::LightCheckRow row(const LightSample& sample, const std::string& source,
                        const std::string& channel, double level) const;
  std::optional<std::array<double, 2>> bandOf(const std::string& sensor) const;

  LightCheck check_;
  calibration::LightModelOptions options_;
  std::map<std::string, std::array<double, 2>> bands_;  // by sensor
  std::string run_id_;
  calibration::ChartOptions charts_;
  calibration::ContentOptions content_options_;
  std::map<Key, Watched> series_;
  std::map<Key, calibration::ContentSeries> contents_;
};

}  // namespace patina::capture
