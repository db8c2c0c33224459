// SPDX-License-Identifier: GPL-3.0-or-later
// What the picture itself says of its light: the mean level of tiles against a robust forecast of
// each. A patch is fooled when it is soiled, and does not see a shadow on the specimen.
//
// Of a tile: an exponentially weighted mean of the logarithm of its level, and the mean absolute
// deviation of what came from it. Of the picture: the median of all tiles' innovations is what is
// common to them, the light; tiles that went elsewhere are a shadow, a visitor, or the specimen.
// A specimen that ages goes on as it did: its common pace has a forecast of its own (Holt's level
// and trend), and what is sudden stands out from that; so do more tiles elsewhere than lately.
#pragma once

#include <optional>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/units.h"

namespace patina::calibration {

// Row by row; linear, share of full scale. At most kTileColumns x kTileRows, fewer where the
// picture is small; a picture under 4x4 pixels has none. Tiles that touch the reference patch are
// 0: it has a vote of its own.
constexpr int kTileColumns = 16, kTileRows = 16;
struct TileLevels {
  int columns = 0, rows = 0;
  std::vector<float> level;
};
// Mean over all channels of about 1,000 samples a tile. O(tiles).
TileLevels measureTiles(ImageView<const float> linear, RectPx patch = {});
// Of whole cells of the mosaic.
TileLevels measureTiles(ImageView<const std::uint16_t> mosaic, double black_level,
                        double white_level, RectPx patch = {});

struct ContentOptions {
  double weight = 0.3;           // of an innovation, for a tile's forecast
  double local_step = 0.08;      // a tile that went elsewhere, relative ...
  double local_scales = 8;       // ... and by so many of its deviations
  double moved_share = 0.10;     // of the tiles: a shadow; fewer is an insect
  double usual_times = 3;        // a specimen that moves: over what is usual
  int patience = 3;              // shots after which what a tile became is what it is
  int learn_samples = 8;         // before anything is said
  double gap_intervals = 2.5;    // unseen for longer than so many usual ones: looks anew
  double dark_level = 0.002;     // tiles below show no light
  double common_noise = 0.0015;  // least deviation of the picture's light from the patch's
  double other_light = 0.05;     // RMS of the tiles' change: the shading is another lamp's
  void check() const;            // throws CalibrationError
};

// The tiles of one camera, light state and exposure. Copyable.
struct ContentSeries {
  int columns = 0, rows = 0, samples = 0;
  std::vector<float> forecast;         // log level
  std::vector<float> deviation;        // mean absolute, of innovations less what is common
  std::vector<unsigned char> strays;   // shots in a row that a tile was elsewhere
  double common_bias = 0;              // what is common less the patch's innovation: the pace of
  double common_trend = 0;             // the specimen, and its change from shot to shot (Holt)
  double common_deviation = 0;         // mean absolute, from what these two foretold
  double last_apart = 0;               // the last shot's
  double usual_share = 0;              // of tiles that are elsewhere; rises by half, falls slowly
  double usual_rms = 0, last_rms = 0;  // of the tiles' innovations less what is common
  double usual_gap_s = 0;
  std::optional<UtcTime> last_utc;
};
struct ContentJudgement {
  bool known = false;       // learned, and light in a quarter of the tiles at least
  double common = 0;        // change of the light as the picture has it, relative; less the pace
                            // at which the specimen darkens or brightens anyway
  double common_noise = 0;  // by which it differs from the patch's while all is well
  double moved_share = 0;   // of tiles that went elsewhere for the first few shots
  double local = 0;         // their median change, relative to what is common
  bool moved = false;       // more of them than is usual
  bool quiet = false;       // apart from what is common, nothing happened that is not usual
};
ContentJudgement judgeContent(const ContentSeries& series, const TileLevels& tiles, UtcTime utc,
                              const ContentOptions& options);
// Of a shot that is taken. `patch`: the innovation of the reference patch, relative.
void takeIn(ContentSeries& series, const TileLevels& tiles, double patch, UtcTime utc,
            const ContentOptions& options);
// Whether `tiles` have the shading of `other` and not that of `own`: two lamps were exchanged.
// What the specimen reflects is in both, and cancels, unless it has just changed by much.
bool hasLightOf(const ContentSeries& other, const ContentSeries& own, const TileLevels& tiles,
                const ContentOptions& options);

}  // namespace patina::calibration
