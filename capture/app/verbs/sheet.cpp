// SPDX-License-Identifier: GPL-3.0-or-later
// patina sheet | keogram: a texture or a run in one picture.
#include "capture/app/context.h"
#include "capture/app/verbs/film_verbs.h"
#include "capture/app/verbs/verbs.h"
#include "capture/workflow/pictures.h"

namespace patina::app {
namespace {

struct SheetOptions : ShowingOptions {
  workflow::SheetRequest sheet;
};
struct KeogramOptions : ShowingOptions {
  workflow::KeogramRequest keogram;
};

void write(Context& context, const std::string& out, const Image<std::uint8_t>& picture) {
  writePng(out, picture.view());
  context.out.asList();
  context.out.add(std::move(Item()
                                .set("path", out.c_str())
                                .set("width_px", picture.width())
                                .set("height_px", picture.height())));
}

void sheet(Context& context, SheetOptions& options) {
  const workflow::Sequence sequence = openShown(context, options);
  options.sheet.show = options.show;
  write(context, options.out, workflow::makeSheet(sequence, options.sheet, context.progress));
}

void keogram(Context& context, KeogramOptions& options) {
  const workflow::Sequence sequence = openShown(context, options);
  options.keogram.show = options.show;
  write(context, options.out, workflow::makeKeogram(sequence, options.keogram, context.progress));
}

constexpr const char* kIn = "A texture's .h5 file, or a texture or run of the archive";

}  // namespace

void addSheetVerbs(Verb root) {
  auto s = std::make_shared<SheetOptions>();
  Verb sheet_verb =
      root.verb("sheet", "Frames side by side with their times", "patina sheet ivy.h5 ivy.png",
                [s](Context& context) { sheet(context, *s); });
  addShowingOptions(sheet_verb, *s, kIn, "The picture to write: .png");
  sheet_verb.option("--cells", s->sheet.cells, 1, 1000, "At most so many frames")
      .option("--columns", s->sheet.columns, 0, 100, "Frames a row (default: as fits)")
      .option("--cell-width", s->sheet.cell_width_px, 16, 4096, "Of a frame, in pixels")
      .option("--region", s->sheet.region, parseRect, "X,Y,W,H", "Of each frame (default: all)");
  auto k = std::make_shared<KeogramOptions>();
  Verb keogram_verb = root.verb("keogram", "One column of every frame, side by side over time",
                                "patina keogram latest keogram.png --archive ivy",
                                [k](Context& context) { keogram(context, *k); });
  addShowingOptions(keogram_verb, *k, kIn, "The picture to write: .png");
  keogram_verb
      .option("--column", k->keogram.column, 0, 1'000'000,
              "Pixels from the left (default: the middle)")
      .option("--width", k->keogram.width_px, 1, 1000, "Columns to average");
}

}  // namespace patina::app
