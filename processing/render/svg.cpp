// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/svg.h"

#include <cstdio>

namespace patina::render {
namespace {

std::string number(double v) {
  char text[40];
  std::snprintf(text, sizeof text, "%.2f", v);
  std::string out = text;
  out.erase(out.find_last_not_of('0') + 1);
  if (out.back() == '.') out.pop_back();
  return out == "-0" ? "0" : out;
}

std::string colourOf(const char* what, Colour c) {
  char text[80];
  std::snprintf(text, sizeof text, "%s=\"#%02x%02x%02x\"", what, c.r, c.g, c.b);
  std::string out = text;
  if (c.alpha < 1) out += " " + std::string(what) + "-opacity=\"" + number(c.alpha) + "\"";
  return out;
}

std::string pointsOf(const std::vector<Point>& points) {
  std::string out = "points=\"";
  for (Point p : points) out += number(p.x) + "," + number(p.y) + " ";
  if (!points.empty()) out.pop_back();
  return out + "\"";
}

// Control characters have no place in XML; the rest is UTF-8 already.
std::string escaped(std::string_view text) {
  std::string out;
  for (char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) >= ' ')
      out += c;
  }
  return out;
}

}  // namespace

void SvgSurface::polygon(const std::vector<Point>& corners, Colour colour) {
  body_ += "<polygon " + pointsOf(corners) + " " + colourOf("fill", colour) + "/>\n";
}

void SvgSurface::line(const std::vector<Point>& points, double width_px, Colour colour,
                      double dash_px) {
  body_ += "<polyline " + pointsOf(points) + " fill=\"none\" " + colourOf("stroke", colour) +
           " stroke-width=\"" + number(width_px) + "\" stroke-linejoin=\"round\"";
  if (dash_px > 0) body_ += " stroke-dasharray=\"" + number(dash_px) + "\"";
  body_ += "/>\n";
}

void SvgSurface::disc(Point centre, double radius_px, Colour colour) {
  body_ += "<circle cx=\"" + number(centre.x) + "\" cy=\"" + number(centre.y) + "\" r=\"" +
           number(radius_px) + "\" " + colourOf("fill", colour) + "/>\n";
}

void SvgSurface::text(Point at, std::string_view text, const TextStyle& style) {
  static constexpr const char* kAnchors[] = {"start", "middle", "end"};
  const std::string place = "x=\"" + number(at.x) + "\" y=\"" + number(at.y) + "\"";
  body_ += "<text " + place + " font-size=\"" + number(style.size_px) + "\" text-anchor=\"" +
           kAnchors[static_cast<int>(style.align)] + "\" " + colourOf("fill", style.colour);
  if (style.upwards)
    body_ += " transform=\"rotate(-90 " + number(at.x) + " " + number(at.y) + ")\"";
  body_ += ">" + escaped(text) + "</text>\n";
}

std::string SvgSurface::finish() const {
  const std::string size = std::to_string(size_.width) + " " + std::to_string(size_.height);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + size +
         "\" font-family=\"DejaVu Sans, Verdana, sans-serif\" role=\"img\">\n"
         "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n" +
         body_ + "</svg>\n";
}

}  // namespace patina::render
