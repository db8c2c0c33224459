// SPDX-License-Identifier: GPL-3.0-or-later
// Texture optimisation on one level: which source patch every target patch shows (Kwatra et al.
// 2005), by search and vote, with uniformity of use (Kaspar et al. 2015). A candidate q is better
// for p than what is there when
//
//   distance(p, q) + uniformity * occupancy(q)
//
// is lower. Occupancy has to be current when a candidate is judged: brought up to date once a pass,
// it lets all patches run to the same places and never settles. It is current here, and the result
// is the same for any number of threads: see docs/decisions/0015.
//
//   lanes      the target's columns of tiles, cut into bands; a lane sweeps one band, tile by tile,
//   in
//              step with the others, so that tiles in work never touch
//   a lane     has its own copy of the occupancy: what all knew before this step, and its own
//   changes a step     ends when all lanes are done; then every lane takes over the others' changes
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/patch/occupancy.h"
#include "processing/patch/patch_distance.h"
#include "processing/patch/similar_patches.h"

namespace patina::patch {

enum class SearchKind {
  kCoherent,    // what the neighbours show, and patches similar to it
  kPatchMatch,  // what two neighbours show, and random places around the present one; patented
};

struct FieldOptions {
  int patch = 5;              // texels; 3, 5 or 7
  double uniformity = 0.075;  // weight of occupancy, where 1 is even use; in units of the features'
                              // squared difference of one patch before their scale
  SearchKind search = SearchKind::kCoherent;
  SimilarOptions similar;
  std::uint64_t seed = 1;
  void check() const;  // throws ProcessingError(kUsage): field, value, range
};

struct FieldEnergy {
  double patch = 0;      // mean squared difference of a patch, without scale
  double occupancy = 0;  // mean; 1: every source texel is used equally
};

class NearestField {
 public:
  // `source` [h][w][8 or 16] integers, `scale` times the features meant; borrowed. Both sizes at
  // least `patch`.
  NearestField(ImageView<const std::int16_t> source, double scale, SizePx target,
               const FieldOptions& options);

  // Centres [h][w] as y * source width + x, at least patch / 2 from the source's edge.
  void start(std::vector<std::int32_t> centres);
  const std::vector<std::int32_t>& centres() const { return centres_; }

  void vote();              // target texels <- mean of what the patches over them show
  void search(int pass);    // one pass over all patches; passes alternate their direction
  void refreshDistances();  // after vote(), before search()
  FieldEnergy energy() const;

 private:
  struct Change {
    std::int32_t from, to;
  };
  struct Tile {
    int x0, x1, y0, y1;
  };
  struct Candidate {
    std::int32_t centre, distance, penalty;
  };

  void layLanes();
  Tile tileOf(int lane, int column, int row, bool forward) const;
  void sweep(int lane, const Tile& tile, int pass, bool forward);
  void propose(std::int32_t centre, const std::int16_t* target, int lane, Candidate& best);
  void proposeNeighbour(int x, int y, int dx, int dy, const std::int16_t* target, int lane,
                        Candidate& best, bool with_similar);
  void proposeSimilar(std::int32_t to, const std::int16_t* target, int lane, Candidate& best);
  void proposeRandom(int x, int y, int pass, const std::int16_t* target, int lane, Candidate& best);
  std::int32_t penalty(const Occupancy& occupancy, std::int32_t centre) const {
    return static_cast<std::int32_t>(
        penalty_scale_ *
        static_cast<float>(occupancy.at(centre % source_.width, centre / source_.width)));
  }
  const std::int16_t* sourceCorner(std::int32_t centre) const {
    return source_.data +
           static_cast<std::ptrdiff_t>(centre / source_.width - reach_) * source_.row_stride +
           static_cast<std::ptrdiff_t>(centre % source_.width - reach_) * source_.channels;
  }
  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(target_size_.width) +
           static_cast<std::size_t>(x);
  }
  void voteTexel(int x, int y);
  void padTarget();

  ImageView<const std::int16_t> source_;
  double scale_;
  SizePx target_size_;
  FieldOptions options_;
  int reach_;
  float penalty_scale_;
  PatchDistance distance_;
  std::vector<SimilarPatches> similar_;  // one, or none for PatchMatch
  Image<std::int16_t> target_;           // with a margin of `reach_` that repeats the edge
  std::vector<std::int32_t> centres_, distances_;

  int tile_px_ = 0, lanes_ = 0, band_ = 0, columns_ = 0, rows_ = 0;
  std::vector<Occupancy> occupancy_;          // a lane
  std::vector<std::vector<Change>> changes_;  // a lane, in this step
};

}  // namespace patina::patch
