// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/choices.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace patina::devices::gphoto2 {

namespace {

constexpr double kToleratedShare = 0.01;
constexpr std::size_t kListedMost = 120;  // some cameras offer more ISO values than fit a message

// A positive number at the front of `text`; takes it away.
std::optional<double> takeNumber(std::string_view& text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  std::size_t length = 0;
  while (length < text.size() && (std::isdigit(static_cast<unsigned char>(text[length])) != 0 ||
                                  text[length] == '.' || text[length] == ','))
    ++length;
  if (length == 0 || length > 15) return std::nullopt;
  std::string digits(text.substr(0, length));
  std::replace(digits.begin(), digits.end(), ',', '.');
  char* end = nullptr;
  const double v = std::strtod(digits.c_str(), &end);
  if (*end != '\0' || !(v >= 0)) return std::nullopt;
  text.remove_prefix(length);
  return v;
}

bool takeChar(std::string_view& text, char c) {
  if (text.empty() || text.front() != c) return false;
  text.remove_prefix(1);
  return true;
}

bool blank(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c == ' '; });
}

std::string formatNumber(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", v);
  return text;
}

template <class Parse>
Result<std::string> nearest(double asked, const Choices& choices, Parse parse,
                            const std::string& what, const std::string& camera) {
  const std::string* best = nullptr;
  double best_apart = HUGE_VAL;
  for (const std::string& choice : choices) {
    const std::optional<double> v = parse(choice);
    if (!v) continue;
    const double apart = std::abs(*v - asked);
    if (apart < best_apart) {
      best_apart = apart;
      best = &choice;
    }
  }
  if (best && best_apart <= kToleratedShare * asked) return *best;
  return fail(Errc::kUnsupported, "camera '" + camera + "': it has no " + what +
                                      "; its choices are: " + listed(choices));
}

bool contains(const std::string& text, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return text.find(word) != std::string::npos; });
}

// How good a choice is among those that give the same files: higher is better.
int quality(const std::string& choice) {
  const std::string text = lowerCase(choice);
  int points = 0;
  if (contains(text, {"mraw", "sraw", "craw", "small", "medium", "s1", "s2", "s3"})) points -= 100;
  if (contains(text, {"large"})) points += 10;
  if (contains(text, {"extra fine", "x.fine", "superfine", "super fine"})) points += 6;
  if (contains(text, {"fine"})) points += 4;
  if (contains(text, {"normal", "std", "standard"})) points += 2;
  if (contains(text, {"basic", "light", "economy"})) points += 1;
  if (contains(text, {"*"})) points += 1;  // Nikon's optimal compression
  return points;
}

std::string describe(FileKinds kinds) {
  return kinds.raw ? (kinds.jpeg ? "raw+jpeg" : "raw") : "jpeg";
}

}  // namespace

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string listed(const Choices& choices) {
  std::string text;
  for (std::size_t i = 0; i < choices.size() && i < kListedMost; ++i)
    text += (i == 0 ? "" : ", ") + choices[i];
  if (choices.size() > kListedMost) text += ", ...";
  return choices.empty() ? "none" : text;
}

std::optional<Nanoseconds> exposureOf(const std::string& choice) {
  std::string_view text = choice;
  std::optional<double> seconds = takeNumber(text);
  if (!seconds) return std::nullopt;
  if (takeChar(text, '/')) {
    const auto below = takeNumber(text);
    if (!below || !(*below > 0)) return std::nullopt;
    *seconds /= *below;
  } else if (std::string_view rest = text; takeChar(rest, ' ')) {
    const auto above = takeNumber(rest);
    if (above) {
      if (!takeChar(rest, '/')) return std::nullopt;
      const auto below = takeNumber(rest);
      if (!below || !(*below > 0)) return std::nullopt;
      *seconds += *above / *below;
      text = rest;
    }
  }
  while (takeChar(text, ' ')) {
  }
  if (!takeChar(text, 's')) takeChar(text, '"');
  if (!blank(text) || !(*seconds > 0) || *seconds > 1e6) return std::nullopt;
  return fromSeconds(*seconds);
}

std::optional<Iso> isoOf(const std::string& choice) {
  const std::string lower = lowerCase(choice);
  std::string_view text = lower;
  if (text.starts_with("iso")) text.remove_prefix(3);
  const auto v = takeNumber(text);
  if (!v || !blank(text) || !(*v >= 1) || *v > 1e8) return std::nullopt;
  return Iso{*v};
}

std::optional<FNumber> fNumberOf(const std::string& choice) {
  const std::string lower = lowerCase(choice);
  std::string_view text = lower;
  if (takeChar(text, 'f')) takeChar(text, '/');
  const auto v = takeNumber(text);
  if (!v || !blank(text) || !(*v > 0.4) || *v > 200) return std::nullopt;
  return FNumber{*v};
}

Result<std::string> matchExposure(Nanoseconds asked, const Choices& choices,
                                  const std::string& camera) {
  const auto parse = [](const std::string& choice) -> std::optional<double> {
    const auto v = exposureOf(choice);
    if (!v) return std::nullopt;
    return toSeconds(*v);
  };
  return nearest(toSeconds(asked), choices, parse, "exposure of " + formatExposure(asked), camera);
}

Result<std::string> matchIso(Iso asked, const Choices& choices, const std::string& camera) {
  const auto parse = [](const std::string& choice) -> std::optional<double> {
    const auto v = isoOf(choice);
    if (!v) return std::nullopt;
    return v->value;
  };
  return nearest(asked.value, choices, parse, "ISO " + formatNumber(asked.value), camera);
}

Result<std::string> matchFNumber(FNumber asked, const Choices& choices, const std::string& camera) {
  const auto parse = [](const std::string& choice) -> std::optional<double> {
    const auto v = fNumberOf(choice);
    if (!v) return std::nullopt;
    return v->value;
  };
  auto match = nearest(asked.value, choices, parse, "f/" + formatNumber(asked.value), camera);
  if (!match)
    match.error().what +=
        " (a lens set by hand: settings.f_number = \"manual\" and the plan says what is set)";
  return match;
}

Result<std::string> matchWord(const std::string& asked, const Choices& choices,
                              const std::string& setting, const std::string& camera) {
  const std::string wanted = lowerCase(asked);
  for (const std::string& choice : choices)
    if (lowerCase(choice) == wanted) return choice;
  return fail(Errc::kUnsupported, "camera '" + camera + "': " + setting + " '" + asked +
                                      "' is none of its choices: " + listed(choices));
}

std::optional<FileKinds> fileKindsOf(const std::string& choice) {
  const std::string text = lowerCase(choice);
  if (contains(text, {"heif", "tiff", "tif"})) return std::nullopt;
  FileKinds kinds;
  kinds.raw = contains(text, {"raw", "nef", "dng", "cr2", "cr3", "arw", "raf", "rw2", "orf"});
  const bool second = text.find('+') != std::string::npos;
  const bool developed =
      contains(text, {"jpeg", "jpg", "exif", "fine", "normal", "basic", "standard"});
  kinds.jpeg = kinds.raw ? second : developed;
  if (!kinds.raw && !kinds.jpeg) return std::nullopt;
  return kinds;
}

Result<std::string> matchFormat(FileKinds asked, const Choices& choices,
                                const std::string& camera) {
  const std::string* best = nullptr;
  for (const std::string& choice : choices) {
    if (fileKindsOf(choice) != asked) continue;
    if (!best || quality(choice) > quality(*best)) best = &choice;
  }
  if (best) return *best;
  return fail(Errc::kUnsupported,
              "camera '" + camera + "': no format of its gives " + describe(asked) +
                  "; its choices are: " + listed(choices) +
                  " (name one with settings \"config.NAME\" and say with format what it gives)");
}

bool soundsAutomatic(const std::string& choice) {
  static const std::array kWords{
      "a",    "s",    "p",       "av",       "tv",       "af-a",     "af-s",
      "af-c", "c-af", "s-af+mf", "one shot", "ai servo", "ai focus", "one-push automatic"};
  const std::string text = lowerCase(choice);
  if (text.find("auto") != std::string::npos) return true;
  if (text.find("-servo") != std::string::npos) return true;
  return std::any_of(kWords.begin(), kWords.end(), [&](const char* word) { return text == word; });
}

}  // namespace patina::devices::gphoto2
