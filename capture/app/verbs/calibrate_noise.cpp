// SPDX-License-Identifier: GPL-3.0-or-later
// patina calibrate noise: gain, read noise and full well by photon transfer.
#include "capture/app/context.h"
#include "capture/app/verbs/calibrate_verbs.h"
#include "capture/workflow/photon_transfer_calibration.h"

namespace patina::app {
namespace {

struct Options {
  workflow::NoiseRequest request;
  std::string source, darks;
};

void measure(Context& context, Options& options) {
  workflow::NoiseRequest& request = options.request;
  if (std::filesystem::is_directory(options.source))
    request.flats = options.source;
  else
    request.run = options.source;
  request.darks = options.darks;
  request.command = "patina calibrate noise";
  request.version = PATINA_VERSION;
  const workflow::NoiseOutcome outcome = workflow::measureNoise(
      context.options.archive, request, context.clock.utc(), context.progress);
  if (!outcome.kept) context.warn("not kept: give --archive DIR to keep it");
  constexpr const char* kColours[] = {"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    const calibration::NoiseModel& noise = outcome.transfer.noise[c];
    const calibration::PhotonTransfer::Channel& channel = outcome.transfer.channels[c];
    if (!channel.well_filled)
      context.warn(std::string(kColours[c]) +
                   ": no flat reached white, so the full well is at least so many electrons");
    Item item;
    if (outcome.kept) item.set("id", std::int64_t{outcome.kept->row.id});
    item.set("colour", kColours[c])
        .set("electrons_per_number", Value{noise.electrons_per_number})
        .set("gain_error", Value{channel.gain_error})
        .set("read_noise_e", Value{noise.read_noise_e})
        .set("full_well_e", Value{noise.full_well_e})
        .set("well_filled", Value{channel.well_filled})
        .set("residual", Value{channel.residual})
        .set("nonlinearity", channel.nonlinearity ? Value{*channel.nonlinearity} : Value{})
        .set("levels", channel.levels.size())
        .set("black_level", Value{noise.black_level})
        .set("white_level", Value{noise.white_level});
    context.out.add(std::move(item));
  }
}

}  // namespace

void addCalibrateNoise(Verb& group) {
  auto o = std::make_shared<Options>();
  workflow::NoiseRequest& r = o->request;
  group
      .verb("noise", "Gain, read noise and full well from pairs of raw flats (photon transfer)",
            "patina calibrate noise flats/ --darks darks/ --camera cam0 --archive ivy",
            [o](Context& context) { measure(context, *o); })
      .required("SOURCE", o->source,
                "A folder of raw flats, each two in order of name a pair of one light, or a run")
      .option("--darks", o->darks, "FOLDER", "A pair or more with the lens closed")
      .option("--light", r.light, "STATE", "Of a run: the flats; the darks are of the state off")
      .option("--camera", r.camera, "ID", "The camera they were taken with")
      .take(
          "--iso", "X", [o](const std::string& text) { o->request.iso = std::stod(text); },
          "Instead of what the pictures say");
}

}  // namespace patina::app
