// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/chart.h"

#include <cmath>

#include "processing/render/canvas.h"
#include "processing/render/font.h"
#include "processing/render/palette.h"
#include "processing/render/svg.h"

namespace patina::render {
namespace {

constexpr double kLabelPx = 13, kTitlePx = 17;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  bool empty() const { return !(low <= high); }
};

// The values' range with room around them, unless the chart fixes an end.
Range finished(Range r, std::optional<double> low, std::optional<double> high, double margin) {
  if (r.empty()) r = {low.value_or(high.value_or(1) - 1), high.value_or(low.value_or(0) + 1)};
  r = {low.value_or(r.low), high.value_or(r.high)};
  const double room =
      r.high > r.low ? (r.high - r.low) * margin : std::max(std::abs(r.low) * 0.05, 1e-9);
  if (!low) r.low -= room;
  if (!high) r.high += room;
  if (!(r.high > r.low)) r.high = r.low + 1;
  return r;
}

struct LegendEntry {
  std::string name;
  Colour colour;
  bool dashed = false;
  enum { kLine, kPoint, kArea } kind = kLine;
  Marker marker = Marker::kDisc;
};

class Painter {
 public:
  Painter(const Chart& chart, Surface& surface) : chart_(chart), out_(surface) {}

  void paint() {
    measure();
    layOut();
    axes();
    for (const ChartSpan& s : chart_.spans)
      area(placeX(s.from), top_, placeX(s.to), bottom_, s.colour);
    for (const ChartBand& b : chart_.bands)
      area(left_, placeY(b.high), right_, placeY(b.low), b.colour);
    for (const ChartLine& line : chart_.lines) drawLine(line);
    for (const ChartPoints& points : chart_.points) drawPoints(points);
    if (nothing_)
      out_.text({(left_ + right_) / 2, (top_ + bottom_) / 2}, "no data",
                {.size_px = kTitlePx, .colour = kFaintInk, .align = Align::kMiddle});
    titleAndLegend();
  }

 private:
  void measure() {
    const auto takeAll = [&](const auto& all) {
      for (const auto& one : all) {
        if (one.x.size() != one.y.size())
          throw ProcessingError(Exit::kUsage, "chart: '" + one.name + "' has " +
                                                  std::to_string(one.x.size()) + " x and " +
                                                  std::to_string(one.y.size()) + " y values");
        for (std::size_t i = 0; i < one.x.size(); ++i) {
          if (!std::isfinite(one.x[i]) || !std::isfinite(one.y[i])) continue;
          x_.take(one.x[i]);
          y_.take(one.y[i]);
        }
      }
    };
    takeAll(chart_.lines);
    takeAll(chart_.points);
    nothing_ = y_.empty();
    for (const ChartBand& b : chart_.bands) {
      y_.take(b.low);
      y_.take(b.high);
    }
    for (const ChartSpan& s : chart_.spans) {
      x_.take(s.from);
      x_.take(s.to);
    }
    x_ = finished(x_, chart_.x_low, chart_.x_high, 0);
    y_ = finished(y_, chart_.y_low, chart_.y_high, 0.08);
    y_ticks_ =
        ticksOf(y_.low, y_.high, std::max(2, (chart_.size.height - 120) / 60), AxisKind::kNumber);
    x_ticks_ =
        ticksOf(x_.low, x_.high, std::max(2, (chart_.size.width - 120) / 110), chart_.x_kind);
  }

  std::vector<LegendEntry> legend() const {
    std::vector<LegendEntry> out;
    const auto add = [&](LegendEntry entry) {
      for (const LegendEntry& old : out)
        if (old.name == entry.name) return;
      if (!entry.name.empty()) out.push_back(std::move(entry));
    };
    for (const ChartLine& l : chart_.lines)
      add({l.name, l.colour, l.dashed, LegendEntry::kLine, Marker::kDisc});
    for (const ChartPoints& p : chart_.points)
      if (!p.x.empty()) add({p.name, p.colour, false, LegendEntry::kPoint, p.marker});
    for (const ChartBand& b : chart_.bands)
      add({b.name, b.colour, false, LegendEntry::kArea, Marker::kDisc});
    for (const ChartSpan& s : chart_.spans)
      add({s.name, s.colour, false, LegendEntry::kArea, Marker::kDisc});
    return out;
  }
  static double entryWidth(const LegendEntry& e) { return 28 + textWidth(e.name, kLabelPx) + 20; }

  // Rows of the legend, each no wider than the plot; it shares the title's line where all fits.
  void layOut() {
    double widest = 0;
    for (const Tick& t : y_ticks_) widest = std::max(widest, textWidth(t.label, kLabelPx));
    left_ = std::round(20 + widest + 8 + (chart_.y_label.empty() ? 0 : 22)) + 0.5;
    right_ = chart_.size.width - 24 + 0.5;
    title_width_ = chart_.title.empty() ? 0 : textWidth(chart_.title, kTitlePx) + 30;
    std::vector<LegendEntry> entries = legend();
    double used = title_width_;
    for (const LegendEntry& e : entries) used += entryWidth(e);
    legend_rows_ = {{}};
    if (title_width_ > 0 && used > right_ - left_) legend_rows_.push_back({});
    used = legend_rows_.size() == 1 ? title_width_ : 0;
    for (LegendEntry& e : entries) {
      if (used + entryWidth(e) > right_ - left_ && used > 0) {
        legend_rows_.push_back({});
        used = 0;
      }
      used += entryWidth(e);
      legend_rows_.back().push_back(std::move(e));
    }
    const bool head = !chart_.title.empty() || !legend_rows_.front().empty();
    top_ = (head ? 26 + 22 * static_cast<double>(legend_rows_.size()) - 8 : 16) + 0.5;
    bottom_ = chart_.size.height - 34 - (chart_.x_label.empty() ? 0 : 22) + 0.5;
  }

  double placeX(double v) const {
    return left_ + (v - x_.low) / (x_.high - x_.low) * (right_ - left_);
  }
  double placeY(double v) const {
    return bottom_ - (v - y_.low) / (y_.high - y_.low) * (bottom_ - top_);
  }

  void area(double x0, double y0, double x1, double y1, Colour colour) {
    x0 = std::clamp(x0, left_, right_);
    x1 = std::clamp(x1, left_, right_);
    y0 = std::clamp(y0, top_, bottom_);
    y1 = std::clamp(y1, top_, bottom_);
    // A short one stays visible.
    if (x1 - x0 < 1.5) x1 = x0 + 1.5;
    if (y1 > y0) out_.box({x0, y0}, {x1, y1}, colour);
  }

  void axes() {
    for (const Tick& t : y_ticks_) {
      const double y = std::round(placeY(t.value)) + 0.5;
      if (t.label.empty() || y < top_ - 1 || y > bottom_ + 1) continue;
      out_.line({{left_, y}, {right_, y}}, 1, kGrid);
      out_.text({left_ - 9, y + 4.5}, t.label,
                {.size_px = kLabelPx, .colour = kInk, .align = Align::kRight});
    }
    for (const Tick& t : x_ticks_) {
      const double x = std::round(placeX(t.value)) + 0.5;
      if (!t.label.empty()) out_.line({{x, top_}, {x, bottom_}}, 1, kGrid);
      out_.line({{x, bottom_}, {x, bottom_ + (t.label.empty() ? 3 : 6)}}, 1, kAxis);
      if (t.label.empty()) continue;
      const double half = textWidth(t.label, kLabelPx) / 2;
      out_.text({std::min(x, chart_.size.width - half - 4), bottom_ + 21}, t.label,
                {.size_px = kLabelPx, .colour = kInk, .align = Align::kMiddle});
    }
    out_.line({{left_, top_}, {left_, bottom_}, {right_, bottom_}}, 1, kAxis);
    const TextStyle style{.size_px = kLabelPx, .colour = kFaintInk, .align = Align::kMiddle};
    if (!chart_.x_label.empty())
      out_.text({(left_ + right_) / 2, chart_.size.height - 12.0}, chart_.x_label, style);
    TextStyle upwards = style;
    upwards.upwards = true;
    if (!chart_.y_label.empty()) out_.text({22, (top_ + bottom_) / 2}, chart_.y_label, upwards);
  }

  // At most four points a pixel column (first, lowest, highest, last): the same picture.
  void drawLine(const ChartLine& line) {
    std::vector<Point> piece, column;
    const auto flushColumn = [&] {
      if (column.size() > 4) {
        const auto [low, high] = std::minmax_element(column.begin(), column.end(),
                                                     [](Point a, Point b) { return a.y < b.y; });
        column = {column.front(), *std::min(low, high), *std::max(low, high), column.back()};
      }
      piece.insert(piece.end(), column.begin(), column.end());
      column.clear();
    };
    const auto flushPiece = [&] {
      flushColumn();
      if (piece.size() == 1) out_.disc(piece[0], line.width_px, line.colour);
      if (piece.size() > 1) out_.line(piece, line.width_px, line.colour, line.dashed ? 6 : 0);
      piece.clear();
    };
    for (std::size_t i = 0; i < line.x.size(); ++i) {
      if (!std::isfinite(line.x[i]) || !std::isfinite(line.y[i])) {
        flushPiece();
        continue;
      }
      const Point p{placeX(line.x[i]), std::clamp(placeY(line.y[i]), top_, bottom_)};
      if (p.x < left_ - 1 || p.x > right_ + 1) continue;
      if (!column.empty() && std::floor(p.x) != std::floor(column.front().x)) flushColumn();
      column.push_back(p);
    }
    flushPiece();
  }

  void drawMarker(Point p, Marker marker, double size, Colour colour) {
    const double r = size / 2;
    switch (marker) {
      case Marker::kDisc:
        out_.disc(p, r, colour);
        break;
      case Marker::kRing:
        out_.disc(p, r + 0.7, colour);
        out_.disc(p, r - 0.9, kWhite);
        break;
      case Marker::kSquare:
        out_.box({p.x - r, p.y - r}, {p.x + r, p.y + r}, colour);
        break;
      case Marker::kCross:
        out_.line({{p.x - r, p.y - r}, {p.x + r, p.y + r}}, 1.8, colour);
        out_.line({{p.x - r, p.y + r}, {p.x + r, p.y - r}}, 1.8, colour);
        break;
    }
  }

  void drawPoints(const ChartPoints& points) {
    for (std::size_t i = 0; i < points.x.size(); ++i) {
      if (!std::isfinite(points.x[i]) || !std::isfinite(points.y[i])) continue;
      const Point p{placeX(points.x[i]), std::clamp(placeY(points.y[i]), top_, bottom_)};
      if (p.x < left_ - 1 || p.x > right_ + 1) continue;
      drawMarker(p, points.marker, points.size_px, points.colour);
    }
  }

  void titleAndLegend() {
    if (!chart_.title.empty())
      out_.text({left_, 27}, chart_.title, {.size_px = kTitlePx, .colour = kInk});
    double y = 22;
    for (const auto& row : legend_rows_) {
      double x = right_ + 20;
      for (const LegendEntry& e : row) x -= entryWidth(e);
      for (const LegendEntry& e : row) {
        if (e.kind == LegendEntry::kLine)
          out_.line({{x, y}, {x + 20, y}}, 2.2, e.colour, e.dashed ? 5 : 0);
        if (e.kind == LegendEntry::kPoint) drawMarker({x + 10, y}, e.marker, 8, e.colour);
        if (e.kind == LegendEntry::kArea) {
          out_.box({x, y - 6}, {x + 20, y + 6}, e.colour);
        }
        out_.text({x + 28, y + 4.5}, e.name, {.size_px = kLabelPx, .colour = kInk});
        x += entryWidth(e);
      }
      y += 22;
    }
  }

  const Chart& chart_;
  Surface& out_;
  Range x_, y_;
  bool nothing_ = false;
  std::vector<Tick> x_ticks_, y_ticks_;
  std::vector<std::vector<LegendEntry>> legend_rows_;
  double left_ = 0, right_ = 0, top_ = 0, bottom_ = 0, title_width_ = 0;
};

void check(SizePx size) {
  if (size.width < 240 || size.height < 160 || size.width > 20000 || size.height > 20000)
    throw ProcessingError(Exit::kUsage, "a chart has 240x160 to 20000x20000 pixels");
}

}  // namespace

Image<std::uint8_t> drawChart(const Chart& chart) {
  check(chart.size);
  Canvas canvas(chart.size, kWhite);
  Painter(chart, canvas).paint();
  return canvas.take();
}

std::string chartSvg(const Chart& chart) {
  check(chart.size);
  SvgSurface svg(chart.size);
  Painter(chart, svg).paint();
  return svg.finish();
}

}  // namespace patina::render
