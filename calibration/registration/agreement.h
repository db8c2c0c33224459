// SPDX-License-Identifier: GPL-3.0-or-later
// How well a frame agrees with its reference once it is laid over it, block by block.
#pragma once

#include "calibration/registration/motion.h"
#include "calibration/registration/prepared_picture.h"

namespace patina::calibration {

enum class BlockState : std::uint8_t { kUnknown, kAgrees, kDisagrees };

struct Agreement {
  double zncc = 0;         // of `local` over all blocks with structure, -1 .. 1
  double share = 0;        // of the blocks that can be judged
  double residual_px = 0;  // median distance by which agreeing blocks still lie apart
  // Standard error of a translation, out of what each block's absence changes (jackknife): a blank
  // surface tells little, a few specks less than they seem to. Infinite when nothing is told.
  double uncertainty_px = 0;
  // Contrast of the frame over the reference's where they agree: within 4 px, and from
  // there to 16 px of that level. Both low: fog. The fine one alone: out of focus.
  double contrast_fine = 1, contrast_coarse = 1;
  int judged_blocks = 0;
  double covered = 0;        // largest connected set of disagreeing blocks, share of those judged
  Image<BlockState> blocks;  // [rows][columns]
  int level = 0, block_px = 0;  // side of a block at that level

  RectPx covered_px;  // around that set, pixels of the reference; empty when there is none
};

// A block of 16 px, at the first level of at most 640 px a side, agrees when its ZNCC is at least
// 0.5 (0.6 of the median where noise makes that less); one without structure when its light,
// against the picture's median, differs by less than a factor of 1.3. With more than 3 % of its
// pixels off by a factor of 1.8 it does not, unless one block in fifty or more is so (fog, blur).
// What lies outside of the frame or the mask is not judged.
Agreement agreementOf(const PreparedPicture& reference, const PreparedPicture& frame,
                      const Motion& frame_from_reference);

// The largest connected set of disagreeing blocks for which `also` is not kDisagrees (of the same
// size, or empty): what is new about it. Fills `covered` and `covered_px`.
void findCovered(Agreement& agreement, const Image<BlockState>& also);

// What of the reference takes part when disagreeing blocks are left out.
Image<std::uint8_t> agreeingPixels(const Agreement& agreement, const PreparedPicture& reference);

}  // namespace patina::calibration
