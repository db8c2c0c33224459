// SPDX-License-Identifier: GPL-3.0-or-later
// A field of a row as what a table cell or a JSON value can hold: integer, real, text or NULL.
// A sink has null(), integer(), real(), text(); a source has isNull(), integer(), real(), text().
#pragma once

#include <string>
#include <string_view>

#include "db/columns.h"

namespace patina::db {

template <class S, std::integral T>
void put(S& sink, T v) {
  sink.integer(static_cast<std::int64_t>(v));
}
template <class S>
void put(S& sink, double v) {
  sink.real(v);
}
template <class S>
void put(S& sink, const std::string& v) {
  sink.text(v);
}
template <class S>
void put(S& sink, UtcTime v) {
  sink.integer(toNs(v));
}
template <class S>
void put(S& sink, MonoTime v) {
  sink.integer(toNs(v));
}
template <class S>
void put(S& sink, Nanoseconds v) {
  sink.integer(v.count());
}
template <class S>
void put(S& sink, Decision v) {
  sink.text(name(v));
}
template <class S>
void put(S& sink, ShotState v) {
  sink.text(name(v));
}
template <class S>
void put(S& sink, const Sha256& v) {
  sink.text(v.hex());
}
template <class S>
void put(S& sink, const std::optional<std::int64_t>& v) {
  v ? sink.integer(*v) : sink.null();
}
template <class S, class T>
void put(S& sink, OrNull<T> v) {
  v.value == T{} ? sink.null() : put(sink, v.value);
}

template <class S, std::integral T>
void get(S& source, T& v) {
  v = static_cast<T>(source.integer());
}
template <class S>
void get(S& source, double& v) {
  v = source.real();
}
template <class S>
void get(S& source, std::string& v) {
  v = source.text();
}
template <class S>
void get(S& source, UtcTime& v) {
  v = utcFromNs(source.integer());
}
template <class S>
void get(S& source, MonoTime& v) {
  v = monoFromNs(source.integer());
}
template <class S>
void get(S& source, Nanoseconds& v) {
  v = Nanoseconds{source.integer()};
}
template <class S>
void get(S& source, Decision& v) {
  v = parseDecision(std::string(source.text()));
}
template <class S>
void get(S& source, ShotState& v) {
  v = parseShotState(std::string(source.text()));
}
template <class S>
void get(S& source, Sha256& v) {
  v = Sha256::fromHex(source.text());
}
template <class S>
void get(S& source, std::optional<std::int64_t>& v) {
  if (source.isNull())
    v.reset();
  else
    v = source.integer();
}
template <class S, class T>
void get(S& source, OrNull<T> v) {
  if (source.isNull())
    v.value = T{};
  else
    get(source, v.value);
}

}  // namespace patina::db
