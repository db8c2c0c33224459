// SPDX-License-Identifier: GPL-3.0-or-later
// Texture optimisation on one level: which source patch every target patch shows (Kwatra et al.
// 2005), by search and vote, with uniformity of use (Kaspar et al. 2015). A candidate q is better
// for p than what is there when
//
//   distance(p, q) + uniformity * occupancy(q)
//
// is lower. Distances are of all components: the leading ones are a bound below that spares most
// candidates the rest. Occupancy has to be current when a candidate is judged: brought up to date
// once a pass, it lets all patches run to the same places and never settles. It is current here,
// and the result is the same for any number of threads: see docs/decisions/0015.
//
// A lane is a band of the target's columns of tiles; it sweeps its band tile by tile, in step with
// the others, so that tiles in work never touch. It has its own copy of the occupancy: what all
// knew before this step, and its own changes. A step ends when all lanes are done; with the next
// one every lane takes over the others' changes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/image.h"
#include "processing/patch/labels.h"
#include "processing/patch/lanes.h"
#include "processing/patch/occupancy.h"
#include "processing/patch/patch_components.h"
#include "processing/patch/similar_patches.h"
#include "processing/patch/votes.h"
#include "processing/patch/wakefulness.h"

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
  SimilarOptions similar = {};
  bool wraps = false;  // the target goes on at its other side
  std::uint64_t seed = 1;
  void check() const;  // throws ProcessingError(kUsage): field, value, range
};

class NearestField;

// Components that candidates are compared on before they are taken: [h][w][4 or 8] of the source,
// borrowed; and of the target [h][w][8], where they are guides.
struct FurtherComponents {
  ImageView<const std::int16_t> source, guide = {};
};

// What limits a field. All spans are copied.
struct FieldLimits {
  std::span<const std::uint8_t> usable = {};  // [h][w] of the source: no patch covers a 0
  std::span<const std::int32_t> kept = {};    // [h][w] of the target: the source texel that is
                                              // shown there whatever the patches say; -1: none
  ImageView<const std::int16_t> guide = {};   // [h][w][n] of the target; n a multiple of 8. The
                                              // source's last n components are its guides
  std::span<const FurtherComponents> further = {};
  const Labels* labels = nullptr;        // copied
  const NearestField* coarse = nullptr;  // of the level above: what is similar there is taken
                                         // to be similar here. Null: an index is made
};

struct FieldEnergy {
  double patch = 0;      // mean squared difference of a patch, without scale
  double occupancy = 0;  // mean; 1: every source texel is used equally
};

class NearestField {
 public:
  // `source` [h][w][4, 8 or 16] integers, `scale` times the features meant; borrowed, rows
  // without gaps. Both sizes at least `patch`. Throws ProcessingError(kUsage) where no patch is
  // usable.
  NearestField(ImageView<const std::int16_t> source, double scale, SizePx target,
               const FieldOptions& options, const FieldLimits& limits = {});

  // Centres [h][w] as y * source width + x, at least patch / 2 from the source's edge. Where one is
  // not usable, a usable one takes its place; what is kept is its own patch's centre, if usable.
  void start(std::vector<std::int32_t> centres);
  // After start() with a field of a coarser level: patches that the four beside them continue sleep
  // until something near them changes. Not where a guide leads: it asks for more on every level.
  void wakeSeams();
  const std::vector<std::int32_t>& centres() const { return centres_; }

  void vote();            // target texels <- mean of what the patches over them show
  void search(int pass);  // one pass; passes alternate their direction. After vote()
  void wakeAll() { wakefulness_.wakeAll(); }  // the next passes judge every patch again
  FieldEnergy energy() const;                 // after vote()

 private:
  struct Change {
    std::int32_t from, to;
  };
  struct Lane {
    Occupancy occupancy;
    std::vector<Change> changes[2];  // in this step and the one before
    void take(const Change& change);
  };
  struct Candidate {
    std::int32_t centre, distance, penalty;
  };
  struct Judge;  // of one target patch, in one lane

  void takeOver(int lane, int step);  // what the other lanes changed in it
  void sweep(int lane, int step, int pass, bool forward);
  void judge(const Lane& lane, int x, int y, int pass, int ahead);
  // `distance` of the leading components, and all others': as soon as that is no less than `bound`,
  // some of them.
  std::int32_t further(std::int32_t distance, int x, int y, std::int32_t centre,
                       std::int32_t bound) const;
  bool fixed(std::size_t at) const {
    return !kept_.empty() && kept_[at] >= 0 && usable_[static_cast<std::size_t>(kept_[at])] != 0;
  }
  std::int32_t neighbour(int x, int y) const;  // index in the target; -1: beyond its edge
  Votes votes() const;
  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(target_size_.width) +
           static_cast<std::size_t>(x);
  }

  ImageView<const std::int16_t> source_;
  double scale_;
  SizePx target_size_;
  FieldOptions options_;
  int reach_;
  float penalty_scale_;
  std::int32_t least_gain_;  // of a candidate that is taken
  std::vector<std::uint8_t> usable_;
  std::vector<std::int32_t> kept_;
  Labels labels_;
  std::vector<SimilarPatches> similar_;  // one, or none for PatchMatch
  PatchComponents leading_;
  std::vector<PatchComponents> further_;
  std::vector<std::int32_t> centres_, distances_;
  std::vector<std::uint8_t> refused_;  // by the labels, since the start; empty without any
  Wakefulness wakefulness_;

  Lanes order_;
  std::vector<Lane> lanes_;
};

}  // namespace patina::patch
