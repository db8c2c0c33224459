// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/font.h"

#include <cstdlib>
#include <map>

#include "processing/image/failure.h"

namespace patina::render {
namespace {

constexpr double kUnitsPerEm = 512;

struct Glyph {
  double advance = 0;
  std::vector<std::vector<Point>> contours;  // font units, y up
};

double number(const char*& p) {
  char* end = nullptr;
  const double v = static_cast<double>(std::strtol(p, &end, 10));
  PATINA_CHECK(end != p);
  p = end;
  return v;
}

// Four chords a curve: below a tenth of a pixel from it at 30 pixels an em.
void addCurve(std::vector<Point>& contour, Point control, Point end) {
  const Point begin = contour.back();
  for (int i = 1; i <= 4; ++i) {
    const double t = i / 4.0, s = 1 - t;
    contour.push_back({s * s * begin.x + 2 * s * t * control.x + t * t * end.x,
                       s * s * begin.y + 2 * s * t * control.y + t * t * end.y});
  }
}

Glyph readGlyph(const char*& p) {
  Glyph glyph;
  glyph.advance = number(p);
  Point at;
  for (; *p != ';'; at = glyph.contours.empty() ? at : glyph.contours.back().back()) {
    const char command = *p++;
    if (command == ' ') continue;
    if (command == 'M') {
      const double x = number(p), y = number(p);
      glyph.contours.push_back({{x, y}});
      continue;
    }
    auto& contour = glyph.contours.back();
    const double a = number(p);
    if (command == 'h') {
      contour.push_back({at.x + a, at.y});
    } else if (command == 'v') {
      contour.push_back({at.x, at.y + a});
    } else {
      const double b = number(p);
      if (command == 'l') {
        contour.push_back({at.x + a, at.y + b});
      } else {
        const double c = number(p), d = number(p);
        addCurve(contour, {at.x + a, at.y + b}, {at.x + c, at.y + d});
      }
    }
  }
  ++p;
  return glyph;
}

const std::map<char32_t, Glyph>& glyphs() {
  static const std::map<char32_t, Glyph> table = [] {
    std::map<char32_t, Glyph> out;
    for (const char* p = kFontOutlines; *p != 0;) {
      const auto code = static_cast<char32_t>(number(p));
      out[code] = readGlyph(p);
    }
    return out;
  }();
  return table;
}

const Glyph& glyphOf(char32_t code) {
  const auto it = glyphs().find(code);
  return it != glyphs().end() ? it->second : glyphs().at(U'?');
}

// Takes one character off the front; a byte that is not UTF-8 is one character.
char32_t takeCharacter(std::string_view& text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const int more = byte(0) >= 0xF0 ? 3 : byte(0) >= 0xE0 ? 2 : byte(0) >= 0xC0 ? 1 : 0;
  char32_t code = more == 0 ? byte(0) : byte(0) & (0x3F >> more);
  std::size_t n = 1;
  for (; n <= static_cast<std::size_t>(more) && n < text.size() && (byte(n) & 0xC0) == 0x80; ++n)
    code = (code << 6) | (byte(n) & 0x3F);
  if (n != static_cast<std::size_t>(more) + 1) code = U'?';
  text.remove_prefix(n);
  return code;
}

}  // namespace

double textWidth(std::string_view text, double size_px) {
  double units = 0;
  while (!text.empty()) units += glyphOf(takeCharacter(text)).advance;
  return units * size_px / kUnitsPerEm;
}

std::vector<std::vector<Point>> textOutlines(std::string_view text, double size_px) {
  const double scale = size_px / kUnitsPerEm;
  std::vector<std::vector<Point>> out;
  double x = 0;
  while (!text.empty()) {
    const Glyph& glyph = glyphOf(takeCharacter(text));
    for (const auto& contour : glyph.contours) {
      auto& to = out.emplace_back();
      to.reserve(contour.size());
      for (Point p : contour) to.push_back({x + p.x * scale, -p.y * scale});
    }
    x += glyph.advance * scale;
  }
  return out;
}

}  // namespace patina::render
