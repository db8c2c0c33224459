// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/plate.h"

#include <algorithm>

#include "processing/image/warp.h"
#include "processing/render/canvas.h"
#include "processing/render/font.h"
#include "processing/render/palette.h"

namespace patina::render {
namespace {

constexpr int kMargin = 24, kGap = 4, kRowGap = 14, kLabelHeight = 20, kTitleHeight = 34;

ImageView<const std::uint8_t> middleSquare(ImageView<const std::uint8_t> picture) {
  const int side = std::min(picture.width, picture.height);
  return picture.crop({(picture.width - side) / 2, (picture.height - side) / 2, side, side});
}

bool hasLabels(const PlateRow& row) { return !row.labels.empty(); }

}  // namespace

std::vector<double> plateTimes(double begin_s, double end_s, int columns) {
  std::vector<double> out;
  for (int i = 0; i < columns; ++i)
    out.push_back(columns == 1 ? begin_s : begin_s + (end_s - begin_s) * i / (columns - 1));
  return out;
}

Image<std::uint8_t> drawPlate(const std::vector<PlateRow>& rows, const PlateOptions& options) {
  const int cell = options.cell_px;
  std::size_t columns = 0;
  double names = 0;
  int height = 2 * kMargin + (options.title.empty() ? 0 : kTitleHeight) - kRowGap;
  for (const PlateRow& row : rows) {
    columns = std::max(columns, row.pictures.size());
    names = std::max({names, textWidth(row.name, 15), textWidth(row.detail, 12)});
    height += cell + (hasLabels(row) ? kLabelHeight : 0) + kRowGap;
  }
  const bool bad_row = std::any_of(rows.begin(), rows.end(), [](const PlateRow& row) {
    return row.pictures.empty() || std::any_of(row.pictures.begin(), row.pictures.end(),
                                               [](const auto& picture) { return picture.empty(); });
  });
  if (rows.empty() || bad_row || cell < 32 || cell > 2048)
    throw ProcessingError(Exit::kUsage,
                          "a plate has at least one row, pictures in each, 32 to 2048 pixels wide");
  const int left = kMargin + static_cast<int>(names) + 18;
  Canvas canvas({left + static_cast<int>(columns) * (cell + kGap) - kGap + kMargin, height},
                kWhite);
  int y = kMargin;
  if (!options.title.empty()) {
    canvas.text({kMargin, y + 14.0}, options.title, {.size_px = 18, .colour = kInk});
    y += kTitleHeight;
  }
  for (const PlateRow& row : rows) {
    const double middle = y + cell / 2.0;
    const TextStyle right{.size_px = 15, .colour = kInk, .align = Align::kRight};
    canvas.text({left - 14.0, middle - (row.detail.empty() ? -5 : 2)}, row.name, right);
    canvas.text({left - 14.0, middle + 16}, row.detail,
                {.size_px = 12, .colour = kFaintInk, .align = Align::kRight});
    for (std::size_t i = 0; i < row.pictures.size(); ++i) {
      const int x = left + static_cast<int>(i) * (cell + kGap);
      canvas.picture(x, y, resizeSrgb(middleSquare(row.pictures[i].view()), {cell, cell}).view());
      if (i < row.labels.size())
        canvas.text({x + cell / 2.0, y + cell + 15.0}, row.labels[i],
                    {.size_px = 12, .colour = kFaintInk, .align = Align::kMiddle});
    }
    y += cell + (hasLabels(row) ? kLabelHeight : 0) + kRowGap;
  }
  return canvas.take();
}

}  // namespace patina::render
