// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/applied_settings.h"

#include <cmath>

namespace patina::devices::gphoto2 {

namespace {

// Which of a camera's words for a place is meant.
Result<std::string> matchTarget(Target target, const Choices& choices, const std::string& who) {
  for (const std::string& choice : choices) {
    const std::string text = lowerCase(choice);
    const bool card = text.find("card") != std::string::npos;
    const bool memory = text.find("ram") != std::string::npos;
    if (card != memory && card == (target == Target::kCard)) return choice;
  }
  return fail(Errc::kUnsupported,
              "camera '" + who + "': it cannot store pictures " +
                  (target == Target::kCard ? "on its card" : "in its memory alone") +
                  "; its choices are: " + listed(choices));
}

// To the library a refused value, and a camera that is busy, may be a setting that it has not; what
// it answers to a write means little. Only what is read back counts.
Result<void> writeAndRead(Session& session, const std::string& name, const std::string& value,
                          const std::string& who) {
  auto done = session.write(name, value);
  if (!done && done.error().code != Errc::kRefused) return done;
  const auto after = session.read(name);
  if (!after) return tl::make_unexpected(after.error());
  if (after->value == value) return {};
  return fail(Errc::kRefused, "camera '" + who + "': " + name + ": asked for '" + value +
                                  "', it is '" + after->value + "'" +
                                  (done ? "" : " (" + done.error().what + ")"));
}

}  // namespace

const std::vector<std::string>& namesFor(const std::string& thing) {
  // Nikon's shutterspeed2 is exact where its shutterspeed is rounded to 0.1 ms.
  static const std::map<std::string, std::vector<std::string>> kNames{
      {"exposure", {"shutterspeed2", "shutterspeed", "exptime"}},
      {"iso", {"iso", "isospeed"}},
      {"f_number", {"aperture", "f-number"}},
      {"format", {"imageformat", "imagequality"}},
      {"white_balance", {"whitebalance"}},
      {"target", {"capturetarget"}},
      {"battery", {"batterylevel"}},
      {"shutter counter", {"shuttercounter"}},
      {"serial", {"eosserialnumber", "serialnumber"}},
      {"model", {"cameramodel"}},
      {"lens", {"lensname"}}};
  static const std::vector<std::string> kNone;
  const auto found = kNames.find(thing);
  return found == kNames.end() ? kNone : found->second;
}

Result<std::pair<std::string, Setting>> readAny(Session& session, const std::string& thing,
                                                const std::string& who) {
  for (const std::string& name : namesFor(thing)) {
    auto setting = session.read(name);
    if (setting) return std::pair{name, std::move(*setting)};
    if (setting.error().code != Errc::kUnsupported) return tl::make_unexpected(setting.error());
  }
  return fail(Errc::kUnsupported, "camera '" + who + "': it has no setting for its " + thing);
}

AppliedSettings::AppliedSettings(const CameraSettings& wanted, std::string who)
    : wanted_(wanted), who_(std::move(who)) {}

Result<void> AppliedSettings::ensure(Session& session, const std::string& name, const Setting& now,
                                     const std::string& value) {
  if (now.value != value) {
    if (now.read_only)
      return fail(Errc::kRefused, "camera '" + who_ + "': " + name + " is '" + now.value +
                                      "' and cannot be set to '" + value +
                                      "' from here: turn its mode dial to M, or set it by hand");
    if (auto done = writeAndRead(session, name, value, who_); !done) return done;
  }
  in_force_[name] = value;
  return {};
}

Result<std::string> AppliedSettings::ensureThing(
    Session& session, const std::string& thing, const std::function<Match(const Choices&)>& match) {
  const auto now = readAny(session, thing, who_);
  if (!now) return tl::make_unexpected(now.error());
  auto value = match(now->second.choices);
  if (!value) return value;
  if (auto done = ensure(session, now->first, now->second, *value); !done)
    return tl::make_unexpected(done.error());
  return value;
}

Result<void> AppliedSettings::applyTarget(Session& session) {
  const auto done = ensureThing(session, "target", [&](const Choices& choices) {
    return matchTarget(wanted_.target, choices, who_);
  });
  if (done) return {};
  // A camera without that choice stores on its card.
  const bool no_choice = done.error().code == Errc::kUnsupported &&
                         done.error().what.find("no setting") != std::string::npos;
  if (no_choice && wanted_.target == Target::kCard) return {};
  return tl::make_unexpected(done.error());
}

Result<void> AppliedSettings::applyFixed(Session& session) {
  if (auto done = applyTarget(session); !done) return done;
  for (const auto& [name, value] : wanted_.config) {
    const auto now = session.read(name);
    if (!now)
      return fail(now.error().code,
                  now.error().what + (now.error().code == Errc::kUnsupported
                                          ? " (of settings \"config." + name +
                                                "\"); it has: " + listed(session.settingNames())
                                          : ""));
    auto word = now->choices.empty() ? Match(value) : matchWord(value, now->choices, name, who_);
    if (!word) return tl::make_unexpected(word.error());
    if (auto done = ensure(session, name, *now, *word); !done) return done;
  }
  const auto& formats = namesFor("format");
  const bool free_format = std::any_of(formats.begin(), formats.end(), [&](const auto& name) {
    return wanted_.config.contains(name);
  });
  if (!free_format) {
    const auto done = ensureThing(session, "format", [&](const Choices& choices) {
      return wanted_.format_word.empty() ? matchFormat(wanted_.files, choices, who_)
                                         : matchWord(wanted_.format_word, choices, "format", who_);
    });
    if (!done) return tl::make_unexpected(done.error());
  }
  if (!wanted_.white_balance) return {};
  const auto done = ensureThing(session, "white_balance", [&](const Choices& choices) {
    return matchWord(*wanted_.white_balance, choices, "white_balance", who_);
  });
  if (!done) return tl::make_unexpected(done.error());
  return {};
}

Result<Applied> AppliedSettings::apply(Session& session, const Exposure& exposure) {
  in_force_.clear();
  if (auto fixed = applyFixed(session); !fixed) return tl::make_unexpected(fixed.error());
  Applied applied{exposure};
  const auto time = ensureThing(session, "exposure", [&](const Choices& choices) {
    return matchExposure(exposure.time, choices, who_);
  });
  if (!time) return tl::make_unexpected(time.error());
  applied.exposure.time = *exposureOf(*time);
  const auto iso = ensureThing(session, "iso", [&](const Choices& choices) {
    return matchIso(exposure.iso, choices, who_);
  });
  if (!iso) return tl::make_unexpected(iso.error());
  applied.exposure.iso = *isoOf(*iso);
  if (wanted_.manual_aperture) return applied;
  const auto f_number = ensureThing(session, "f_number", [&](const Choices& choices) {
    return matchFNumber(exposure.f_number, choices, who_);
  });
  if (!f_number) return tl::make_unexpected(f_number.error());
  applied.exposure.f_number = *fNumberOf(*f_number);
  return applied;
}

Result<Exposure> AppliedSettings::present(Session& session, const Exposure& fallback) const {
  Exposure now = fallback;
  const auto ask = [&](const char* thing) -> Result<std::string> {
    const auto setting = readAny(session, thing, who_);
    if (setting) return setting->second.value;
    if (setting.error().code == Errc::kUnsupported) return std::string();
    return tl::make_unexpected(setting.error());
  };
  const auto time = ask("exposure"), iso = ask("iso"), f_number = ask("f_number");
  for (const auto* answer : {&time, &iso, &f_number})
    if (!*answer) return tl::make_unexpected(answer->error());
  if (const auto v = exposureOf(*time)) now.time = *v;
  if (const auto v = isoOf(*iso)) now.iso = *v;
  if (const auto v = fNumberOf(*f_number)) now.f_number = *v;
  return now;
}

tl::unexpected<Error> AppliedSettings::changed(const std::string& name, const std::string& was,
                                               const std::string& is) const {
  return fail(Errc::kRefused, "camera '" + who_ + "': " + name + " was '" + was + "' and is '" +
                                  is + "' now: it changed by itself");
}

Result<void> AppliedSettings::verify(Session& session) const {
  for (const auto& [name, value] : in_force_) {
    const auto now = session.read(name);
    if (!now) return tl::make_unexpected(now.error());
    if (now->value != value) return changed(name, value, now->value);
  }
  return {};
}

bool agrees(double told, double applied) {
  return std::abs(std::log2(told / applied)) <= 1.0 / 6 + 0.02;
}

}  // namespace patina::devices::gphoto2
