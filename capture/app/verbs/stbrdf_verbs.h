// SPDX-License-Identifier: GPL-3.0-or-later
// The verbs of `patina stbrdf`, a file each.
#pragma once

#include <string>
#include <vector>

#include "capture/app/context.h"
#include "processing/stbrdf/material.h"
#include "processing/stbrdf/samples_file.h"

namespace patina::app {

void addStbrdfFitVerb(Verb stbrdf);
void addStbrdfReportVerb(Verb stbrdf);
void addStbrdfEvaluateVerb(Verb stbrdf);
void addStbrdfConvertVerb(Verb stbrdf);
void addStbrdfEnlargeVerb(Verb stbrdf);
void addStbrdfTransferVerb(Verb stbrdf);

// A time of every texel's own from maps (grey_picture.h), brought to `size`; without a name: none.
stbrdf::LocalTime localTime(double time, const std::string& rate, const std::string& start,
                            SizePx size);

// The samples named on a command line; warns where nothing tells their times.
stbrdf::SampleSet openSamples(const Context& context, const std::vector<std::string>& inputs);

// Those of a BRDF and of its shape that all steps have, or the names asked for.
std::vector<std::string> mapsToFit(const stbrdf::SampleSet& set,
                                   const std::vector<std::string>& asked);

}  // namespace patina::app
