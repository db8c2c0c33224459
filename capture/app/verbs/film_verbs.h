// SPDX-License-Identifier: GPL-3.0-or-later
// What film, sheet and keogram have in common: IN, OUT, which frames, how bright.
#pragma once

#include "capture/app/verbs/frame_options.h"
#include "capture/workflow/film.h"

namespace patina::app {

struct ShowingOptions : FrameOptions {
  std::string in, out, overlay;
  workflow::ShowOptions show;
};
// `options` lives until the verb has run.
void addShowingOptions(Verb& verb, ShowingOptions& options, const std::string& in,
                       const std::string& out);
// IN with --overlay laid over it, whose exposure is then settled in `options`.
workflow::Sequence openShown(Context& context, ShowingOptions& options);

}  // namespace patina::app
