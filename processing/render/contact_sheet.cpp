// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/contact_sheet.h"

#include <cmath>

#include "processing/image/warp.h"
#include "processing/render/canvas.h"
#include "processing/render/font.h"
#include "processing/render/palette.h"

namespace patina::render {
namespace {

constexpr int kMargin = 24, kGap = 12, kLabelHeight = 24, kTitleHeight = 34;

SizePx cellSize(const std::vector<SheetCell>& cells, int width) {
  for (const SheetCell& cell : cells)
    if (cell.picture && !cell.picture->empty())
      return {width, std::clamp(fitInside(cell.picture->size(), {width, 1 << 20}).height, width / 4,
                                width * 4)};
  return {width, width};
}

int columnsFor(std::size_t cells, SizePx cell) {
  const double wide = cell.width + kGap, high = cell.height + kLabelHeight + kGap;
  const double columns = std::sqrt(static_cast<double>(cells) * 1.5 * high / wide);
  return std::clamp(static_cast<int>(std::lround(columns)), 1, static_cast<int>(cells));
}

void drawCell(Canvas& canvas, const SheetCell& cell, RectPx place) {
  const double middle = place.x + place.width / 2.0;
  if (cell.picture && !cell.picture->empty()) {
    const auto& picture = *cell.picture;
    const SizePx size = fitInside(picture.size(), {place.width, place.height});
    canvas.picture(place.x + (place.width - size.width) / 2,
                   place.y + (place.height - size.height) / 2,
                   resizeSrgb(picture.view(), size).view());
  } else {
    canvas.hatch(place, kMissingGround, kMissingStripe);
    const std::string note = cell.note.empty() ? "no picture" : cell.note;
    const double half = textWidth(note, 13) / 2 + 6, y = place.y + place.height / 2.0;
    canvas.box({middle - half, y - 11}, {middle + half, y + 9}, kMissingGround);
    canvas.text({middle, y + 4}, note, {.size_px = 13, .colour = kInk, .align = Align::kMiddle});
  }
  const double size = std::min(13.0, 13.0 * place.width / std::max(1.0, textWidth(cell.label, 13)));
  canvas.text({middle, place.y + place.height + 17.0}, cell.label,
              {.size_px = size, .colour = kInk, .align = Align::kMiddle});
}

}  // namespace

Image<std::uint8_t> drawContactSheet(const std::vector<SheetCell>& cells,
                                     const SheetOptions& options) {
  if (cells.empty() || options.cell_width_px < 16 || options.cell_width_px > 4096 ||
      options.columns < 0)
    throw ProcessingError(Exit::kUsage,
                          "a contact sheet has at least one cell, 16 to 4096 pixels wide");
  const SizePx cell = cellSize(cells, options.cell_width_px);
  const int columns = options.columns > 0
                          ? std::min<int>(options.columns, static_cast<int>(cells.size()))
                          : columnsFor(cells.size(), cell);
  const int rows = (static_cast<int>(cells.size()) + columns - 1) / columns;
  const int head = options.title.empty() ? 0 : kTitleHeight;
  const int row_height = cell.height + kLabelHeight + kGap;
  Canvas canvas({2 * kMargin + columns * (cell.width + kGap) - kGap,
                 2 * kMargin + head + rows * row_height - kGap},
                kWhite);
  if (head > 0)
    canvas.text({kMargin, kMargin + 14.0}, options.title, {.size_px = 18, .colour = kInk});
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int column = static_cast<int>(i) % columns, row = static_cast<int>(i) / columns;
    drawCell(canvas, cells[i],
             {kMargin + column * (cell.width + kGap), kMargin + head + row * row_height, cell.width,
              cell.height});
  }
  return canvas.take();
}

}  // namespace patina::render
