// SPDX-License-Identifier: GPL-3.0-or-later
// Coverage by signed areas: every edge adds, to the cells of its row, the area to its right that it
// changes; a running sum along the row is then the coverage. Overlaps of shapes that turn the same
// way add up and are cut at 1, which is their union.
#include "processing/render/canvas.h"

#include <cmath>
#include <numbers>

#include "processing/render/font.h"

namespace patina::render {
namespace {

using Contour = std::vector<Point>;

class Coverage {
 public:
  Coverage(int width, int height)
      : width_(width), height_(height), cells_(static_cast<std::size_t>(width + 2) * height) {}

  void add(Point a, Point b) {
    if (a.y == b.y) return;
    const double turn = a.y < b.y ? 1 : -1;
    if (turn < 0) std::swap(a, b);
    const double slope = (b.x - a.x) / (b.y - a.y);
    const double top = std::max(a.y, 0.0), bottom = std::min<double>(b.y, height_);
    for (int row = static_cast<int>(top); row < bottom; ++row) {
      const double y0 = std::max<double>(row, top), y1 = std::min<double>(row + 1, bottom);
      if (y1 <= y0) continue;
      addInRow(row, a.x + (y0 - a.y) * slope, a.x + (y1 - a.y) * slope, turn * (y1 - y0));
    }
  }
  std::span<const float> row(int y) const {
    return {cells_.data() + static_cast<std::size_t>(y) * (width_ + 2),
            static_cast<std::size_t>(width_)};
  }

 private:
  // An edge within one row, from x0 to x1, that covers `height` of it.
  void addInRow(int row, double x0, double x1, double height) {
    if (x0 > x1) std::swap(x0, x1);
    x0 = std::clamp<double>(x0, 0, width_);
    x1 = std::clamp<double>(x1, 0, width_);
    float* cells = cells_.data() + static_cast<std::size_t>(row) * (width_ + 2);
    const int first = static_cast<int>(x0), last = static_cast<int>(x1);
    if (first == last || x1 - x0 < 1e-9) {
      const double right = first + 1 - (x0 + x1) / 2;  // share of the cell to the edge's right
      cells[first] += static_cast<float>(height * right);
      cells[first + 1] += static_cast<float>(height * (1 - right));
      return;
    }
    const double per_pixel = height / (x1 - x0);
    double covered = 0;  // by cells up to here, as a running sum would have it
    for (int x = first; x <= last; ++x) {
      // Mean over the cell of the height that lies left of each of its points.
      const double from = std::max<double>(x, x0), to = std::min<double>(x + 1, x1);
      const double h0 = (from - x0) * per_pixel, h1 = (to - x0) * per_pixel;
      const double mean = (h0 + h1) / 2 * (to - from) + h1 * (x + 1 - to);
      cells[x] += static_cast<float>(mean - covered);
      covered = mean;
    }
    cells[last + 1] += static_cast<float>(height - covered);
  }

  int width_, height_;
  std::vector<float> cells_;
};

Contour discOf(Point centre, double radius) {
  const int n = std::clamp(static_cast<int>(radius * 4), 8, 64);
  Contour out;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    out.push_back({centre.x + radius * std::cos(angle), centre.y + radius * std::sin(angle)});
  }
  return out;
}

// Turns the same way as discOf, so that they can share a Coverage.
Contour strokeOf(Point a, Point b, double width) {
  const double dx = b.x - a.x, dy = b.y - a.y, length = std::hypot(dx, dy);
  if (!(length > 1e-9)) return {};
  const double nx = -dy / length * width / 2, ny = dx / length * width / 2;
  return {{a.x - nx, a.y - ny}, {b.x - nx, b.y - ny}, {b.x + nx, b.y + ny}, {a.x + nx, a.y + ny}};
}

bool turnsSharply(Point a, Point b, Point c) {
  const double ux = b.x - a.x, uy = b.y - a.y, vx = c.x - b.x, vy = c.y - b.y;
  return ux * vx + uy * vy < 0.8 * std::hypot(ux, uy) * std::hypot(vx, vy);
}

// The pieces of a line that are drawn when `dash` pixels are on and as many off.
std::vector<Contour> dashesOf(const Contour& points, double dash) {
  std::vector<Contour> out;
  double left = dash;
  bool on = true;
  Contour piece{points.front()};
  for (std::size_t i = 1; i < points.size(); ++i) {
    Point at = points[i - 1];
    for (double length = std::hypot(points[i].x - at.x, points[i].y - at.y); length > left;) {
      at = {at.x + (points[i].x - at.x) * left / length,
            at.y + (points[i].y - at.y) * left / length};
      piece.push_back(at);
      if (on) out.push_back(piece);
      piece = {at};
      on = !on;
      length -= left;
      left = dash;
    }
    left -= std::hypot(points[i].x - at.x, points[i].y - at.y);
    piece.push_back(points[i]);
  }
  if (on && piece.size() > 1) out.push_back(piece);
  return out;
}

bool isFinite(const Contour& contour) {
  return std::all_of(contour.begin(), contour.end(), [](Point p) {
    return std::abs(p.x) < 1e7 && std::abs(p.y) < 1e7;  // false for NaN
  });
}

}  // namespace

Canvas::Canvas(SizePx size, Colour background) : image_(size.width, size.height, 3) {
  for (std::size_t i = 0; i < image_.texels().size(); i += 3) {
    image_.texels()[i] = background.r;
    image_.texels()[i + 1] = background.g;
    image_.texels()[i + 2] = background.b;
  }
}

void Canvas::blend(int x, int y, Colour colour, double coverage) {
  const double a = colour.alpha * coverage;
  std::uint8_t* texel = image_.view().texel(x, y).data();
  const std::uint8_t to[3] = {colour.r, colour.g, colour.b};
  for (int c = 0; c < 3; ++c)
    texel[c] = static_cast<std::uint8_t>(std::lround(texel[c] + a * (to[c] - texel[c])));
}

void Canvas::fill(std::span<const std::vector<Point>> contours, Colour colour) {
  double left = 1e9, right = -1e9, top = 1e9, bottom = -1e9;
  for (const Contour& contour : contours) {
    if (!isFinite(contour)) return;
    for (Point p : contour) {
      left = std::min(left, p.x);
      right = std::max(right, p.x);
      top = std::min(top, p.y);
      bottom = std::max(bottom, p.y);
    }
  }
  const int x0 = std::max(0, static_cast<int>(std::floor(left)));
  const int y0 = std::max(0, static_cast<int>(std::floor(top)));
  const int x1 = std::min(image_.width(), static_cast<int>(std::ceil(right)));
  const int y1 = std::min(image_.height(), static_cast<int>(std::ceil(bottom)));
  if (x0 >= x1 || y0 >= y1) return;
  Coverage coverage(x1 - x0, y1 - y0);
  for (const Contour& contour : contours)
    for (std::size_t i = 0; i < contour.size(); ++i) {
      const Point a = contour[i], b = contour[(i + 1) % contour.size()];
      coverage.add({a.x - x0, a.y - y0}, {b.x - x0, b.y - y0});
    }
  for (int y = y0; y < y1; ++y) {
    float sum = 0;
    int x = x0;
    for (float cell : coverage.row(y - y0)) {
      sum += cell;
      const float covered = std::min(std::abs(sum), 1.0f);
      if (covered > 1e-3f) blend(x, y, colour, covered);
      ++x;
    }
  }
}

void Canvas::polygon(const std::vector<Point>& corners, Colour colour) {
  fill(std::span(&corners, 1), colour);
}

void Canvas::line(const std::vector<Point>& points, double width_px, Colour colour,
                  double dash_px) {
  if (points.size() < 2 || !isFinite(points)) return;
  std::vector<Contour> shapes;
  for (const Contour& piece :
       dash_px > 0 ? dashesOf(points, dash_px) : std::vector<Contour>{points}) {
    for (std::size_t i = 1; i < piece.size(); ++i)
      if (auto stroke = strokeOf(piece[i - 1], piece[i], width_px); !stroke.empty())
        shapes.push_back(std::move(stroke));
    // A round joint adds its soft border to that of the strokes: only where a corner needs one.
    for (std::size_t i = 1; i + 1 < piece.size() && width_px > 1; ++i)
      if (turnsSharply(piece[i - 1], piece[i], piece[i + 1]))
        shapes.push_back(discOf(piece[i], width_px / 2));
  }
  fill(shapes, colour);
}

void Canvas::disc(Point centre, double radius_px, Colour colour) {
  polygon(discOf(centre, radius_px), colour);
}

void Canvas::text(Point at, std::string_view text, const TextStyle& style) {
  const double width = textWidth(text, style.size_px);
  const double shift = style.align == Align::kLeft     ? 0
                       : style.align == Align::kMiddle ? width / 2
                                                       : width;
  auto outlines = textOutlines(text, style.size_px);
  for (Contour& contour : outlines)
    for (Point& p : contour) {
      const double x = p.x - shift, y = p.y;
      p = style.upwards ? Point{at.x + y, at.y - x} : Point{at.x + x, at.y + y};
    }
  fill(outlines, style.colour);
}

void Canvas::picture(int x, int y, ImageView<const std::uint8_t> srgb) {
  PATINA_CHECK(srgb.channels == 1 || srgb.channels == 3);
  for (int sy = std::max(0, -y); sy < srgb.height && y + sy < image_.height(); ++sy)
    for (int sx = std::max(0, -x); sx < srgb.width && x + sx < image_.width(); ++sx)
      for (int c = 0; c < 3; ++c)
        image_.at(x + sx, y + sy, c) = srgb.at(sx, sy, srgb.channels == 3 ? c : 0);
}

void Canvas::hatch(RectPx rect, Colour ground, Colour stripe) {
  constexpr int kPeriod = 9;
  for (int y = std::max(0, rect.y); y < std::min(image_.height(), rect.y + rect.height); ++y)
    for (int x = std::max(0, rect.x); x < std::min(image_.width(), rect.x + rect.width); ++x) {
      blend(x, y, ground, 1);
      const int phase = (x + y) % kPeriod;  // a stripe 2 pixels wide with soft sides
      blend(x, y, stripe, phase == 0 ? 1.0 : phase == 1 || phase == kPeriod - 1 ? 0.5 : 0.0);
    }
}

}  // namespace patina::render
