// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/visitors.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "devices/twin/point.h"
#include "devices/twin/ramps.h"
#include "devices/twin/row_loop.h"
#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

// Of the shorter side of the picture.
constexpr float kHandEdge = 0.015f, kHandRound = 0.045f;
constexpr double kHandReach = 0.42;  // of its middle from the middle of the picture
constexpr float kHandRim = 0.55f;    // what a surface that turns away is left of its light
constexpr double kInsectHalf = 0.018, kInsectLeastPx = 1.5;
constexpr float kInsectKeeps = 0.04f;  // of the light under it

struct Flat {
  float x = 0, y = 0;
};
Flat operator+(Flat a, Flat b) { return {a.x + b.x, a.y + b.y}; }
Flat operator*(float s, Flat a) { return {s * a.x, s * a.y}; }
Flat towards(double angle) {
  return {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle))};
}

// A line with a thickness of its own at each end.
struct Limb {
  Flat from, to;
  float radius_from = 0, radius_to = 0;

  // Below 0 inside.
  float distance(Flat p) const {
    const Flat along = {to.x - from.x, to.y - from.y}, off = {p.x - from.x, p.y - from.y};
    const float length2 = along.x * along.x + along.y * along.y;
    const float t = saturate((off.x * along.x + off.y * along.y) / length2);
    return std::hypot(off.x - t * along.x, off.y - t * along.y) - mix(radius_from, radius_to, t);
  }
};

template <std::size_t N>
float nearest(const std::array<Limb, N>& limbs, Flat p) {
  float d = limbs[0].distance(p);
  for (std::size_t i = 1; i < N; ++i) d = std::min(d, limbs[i].distance(p));
  return d;
}

using Hand = std::array<Limb, 7>;  // arm, palm, four fingers, thumb

Hand handOf(std::uint64_t key) {
  const double angle = 2 * M_PI * uniform(hashSeed(key, 1));
  const Flat middle{static_cast<float>(kHandReach * (2 * uniform(hashSeed(key, 2)) - 1)),
                    static_cast<float>(kHandReach * (2 * uniform(hashSeed(key, 3)) - 1))};
  const Flat back = towards(angle), side = towards(angle + M_PI / 2);
  const float left = uniform(hashSeed(key, 4)) < 0.5 ? -1.0f : 1.0f;
  Hand hand;
  hand[0] = {middle + 0.1f * back, middle + 2.5f * back, 0.062f, 0.16f};
  hand[1] = {middle + 0.06f * back, middle + -0.04f * back, 0.078f, 0.09f};
  for (int i = 0; i < 4; ++i) {
    const float across = left * (0.066f - 0.044f * static_cast<float>(i));
    const double spread = radians(left * (9.0 - 6.0 * i));
    const float length = 0.15f + (i == 1 || i == 2 ? 0.035f : i == 3 ? -0.02f : 0.01f);
    const Flat root = middle + -0.08f * back + across * side;
    const Flat along = towards(angle + M_PI - spread);
    hand[2 + static_cast<std::size_t>(i)] = {root, root + length * along, 0.026f, 0.02f};
  }
  const Flat root = middle + 0.02f * back + (left * 0.07f) * side;
  hand[6] = {root, root + 0.14f * towards(angle + M_PI - left * radians(48)), 0.032f, 0.022f};
  return hand;
}

float shareOf(float distance) {
  return 1 - smooth01(saturate((distance + kHandEdge) / (2 * kHandEdge)));
}

struct HandAt {
  SizePx size;
  Hand hand;
  float distance(int x, int y) const {
    const float scale = 1.0f / static_cast<float>(std::min(size.width, size.height));
    return nearest(hand, {(static_cast<float>(x) + 0.5f - 0.5f * size.width) * scale,
                          (static_cast<float>(y) + 0.5f - 0.5f * size.height) * scale});
  }
};

}  // namespace

std::vector<float> handShare(SizePx size, std::uint64_t key) {
  const HandAt at{size, handOf(key)};
  std::vector<float> share(static_cast<std::size_t>(size.width) * size.height);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      share[static_cast<std::size_t>(y) * size.width + x] = shareOf(at.distance(x, y));
  return share;
}

void drawHand(std::vector<float>& light, const std::vector<float>& white, SizePx size,
              std::uint64_t key) {
  const HandAt at{size, handOf(key)};
  const Rgb color = fromSrgb(205, 154, 128);
  const std::array<float, 3> skin{color.r, color.g, color.b};
  forRowBlocks(size, [&](int y0, int y1) {
    for (int y = y0; y < y1; ++y)
      for (int x = 0; x < size.width; ++x) {
        const float distance = at.distance(x, y), share = shareOf(distance);
        if (share <= 0) continue;
        const std::size_t k = static_cast<std::size_t>(y) * size.width + x;
        // Limbs are round: they turn away from the camera at their edge.
        const float inward = saturate(-distance / kHandRound);
        const float turned = mix(kHandRim, 1, std::sqrt(inward * (2 - inward)));
        const float own = white[k] * turned * skin[(x & 1) + (y & 1)];
        light[k] = mix(light[k], own, share);
      }
  });
}

InsectPlace insectAt(SizePx size, std::uint64_t key, double walked) {
  const double side = std::min(size.width, size.height);
  const double angle = 2 * M_PI * uniform(hashSeed(key, 1));
  const double phase = 2 * M_PI * uniform(hashSeed(key, 2)),
               phase2 = 2 * M_PI * uniform(hashSeed(key, 3));
  const double half_way = 0.5 * std::hypot(size.width, size.height);
  const double forward = half_way * (2 * walked - 1);
  constexpr double kSlow = 2 * M_PI * 1.4, kFast = 2 * M_PI * 5.3;
  const double aside =
      side * (0.14 * std::sin(kSlow * walked + phase) + 0.02 * std::sin(kFast * walked + phase2));
  const double turn = side *
                      (0.14 * kSlow * std::cos(kSlow * walked + phase) +
                       0.02 * kFast * std::cos(kFast * walked + phase2)) /
                      (2 * half_way);
  const double c = std::cos(angle), s = std::sin(angle);
  InsectPlace place;
  place.x_px = 0.5 * size.width + c * forward - s * aside;
  place.y_px = 0.5 * size.height + s * forward + c * aside;
  place.heading_rad = angle + std::atan(turn);
  place.half_length_px = std::max(kInsectHalf * side, kInsectLeastPx);
  return place;
}

void drawInsect(std::vector<float>& light, SizePx size, const InsectPlace& place) {
  // In half lengths, it looks along +x.
  std::array<Limb, 8> limbs;
  limbs[0] = {{-0.65f, 0}, {0.25f, 0}, 0.35f, 0.28f};
  limbs[1] = {{0.7f, 0}, {0.8f, 0}, 0.2f, 0.2f};
  std::size_t next = 2;
  for (const float sign : {-1.0f, 1.0f})
    for (const float at : {-0.45f, 0.0f, 0.4f})
      limbs[next++] = {{at, 0}, {1.9f * at, sign * 1.05f}, 0.06f, 0.04f};
  const auto half = static_cast<float>(place.half_length_px);
  const Flat along = towards(place.heading_rad);
  const int reach = static_cast<int>(std::ceil(1.6 * place.half_length_px)) + 1;
  const int mx = static_cast<int>(std::floor(place.x_px)),
            my = static_cast<int>(std::floor(place.y_px));
  for (int y = std::max(0, my - reach); y <= std::min(size.height - 1, my + reach); ++y)
    for (int x = std::max(0, mx - reach); x <= std::min(size.width - 1, mx + reach); ++x) {
      const Flat off{(x + 0.5f - static_cast<float>(place.x_px)) / half,
                     (y + 0.5f - static_cast<float>(place.y_px)) / half};
      const float distance =
          nearest(limbs, {off.x * along.x + off.y * along.y, off.y * along.x - off.x * along.y});
      const float share = saturate(0.5f - distance * half);
      light[static_cast<std::size_t>(y) * size.width + x] *= mix(1, kInsectKeeps, share);
    }
}

}  // namespace patina::devices::twin
