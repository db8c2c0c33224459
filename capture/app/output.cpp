// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/output.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace patina::app {
namespace {

using Json = nlohmann::ordered_json;

Json toJson(const Value& value) {
  return std::visit(
      [](const auto& v) -> Json {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate>)
          return nullptr;
        else if constexpr (std::is_same_v<T, double>)
          return std::isfinite(v) ? Json(v) : Json();
        else
          return v;
      },
      value);
}

// File names need not be UTF-8; JSON must be.
std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string numberText(double v) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", v);
  return text;
}

std::string toText(const Item::Field& field) {
  if (!field.text.empty()) return field.text;
  return std::visit(
      [](const auto& v) -> std::string {
        using T = std::decay_t<decltype(v)>;
        if constexpr (std::is_same_v<T, std::monostate>)
          return "-";
        else if constexpr (std::is_same_v<T, bool>)
          return v ? "yes" : "no";
        else if constexpr (std::is_same_v<T, std::int64_t>)
          return std::to_string(v);
        else if constexpr (std::is_same_v<T, double>)
          return numberText(v);
        else if constexpr (std::is_same_v<T, std::string>)
          return v.empty() ? "-" : v;
        else {
          std::string joined;
          for (const std::string& one : v) joined += (joined.empty() ? "" : ", ") + one;
          return joined.empty() ? "-" : joined;
        }
      },
      field.value);
}

constexpr const char* kHidden = "\1";

bool isHidden(const Item::Field& field) { return field.text == kHidden; }
bool isNumber(const Value& v) {
  return std::holds_alternative<std::int64_t>(v) || std::holds_alternative<double>(v);
}

// "due_utc_ns" is a key; people read "due".
std::string heading(std::string key) {
  for (const char* unit : {"_utc_ns", "_ns"})
    if (const std::string tail = unit; key.size() > tail.size() && key.ends_with(tail))
      return key.substr(0, key.size() - tail.size());
  std::replace(key.begin(), key.end(), '_', ' ');
  return key;
}

// Columns a terminal shows, not bytes: continuation bytes of UTF-8 take no room.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

}  // namespace

Item& Item::set(const std::string& key, Value value, const std::string& text) {
  fields_.push_back({key, std::move(value), text});
  return *this;
}

Item& Item::set(const std::string& key, UtcTime value) {
  return set(key, Value{toNs(value)}, formatUtc(value));
}

Item& Item::set(const std::string& key, Nanoseconds value) {
  return set(key, Value{std::int64_t{value.count()}}, formatDuration(value));
}

Item& Item::bytes(const std::string& key, std::uint64_t value) {
  return set(key, Value{static_cast<std::int64_t>(value)}, formatBytes(value));
}

Item& Item::hidden(const std::string& key, Value value) {
  return set(key, std::move(value), kHidden);
}

Output::Output(std::string verb, bool json, bool quiet)
    : verb_(std::move(verb)), json_(json), quiet_(quiet) {}

std::string Output::text() const {
  if (!json_) {
    std::string text;
    if (!quiet_)
      for (const std::string& sentence : sentences_) text += sentence + "\n";
    return text + (list_ ? list() : table());
  }
  std::string schema = verb_;
  std::replace(schema.begin(), schema.end(), ' ', '.');
  Json items = Json::array();
  for (const Item& item : items_) {
    Json object = Json::object();
    for (const Item::Field& field : item.fields()) object[field.key] = toJson(field.value);
    items.push_back(std::move(object));
  }
  return dump(Json{{"schema", "patina." + schema + "/1"}, {"items", std::move(items)}}) + "\n";
}

std::string Output::list() const {
  std::string text;
  for (const Item& item : items_) {
    std::size_t width = 0;
    for (const Item::Field& field : item.fields())
      if (!isHidden(field)) width = std::max(width, widthOf(heading(field.key)));
    for (const Item::Field& field : item.fields()) {
      if (isHidden(field)) continue;
      const std::string name = heading(field.key);
      text += name + std::string(width - widthOf(name) + 2, ' ') + toText(field) + "\n";
    }
    if (items_.size() > 1) text += "\n";
  }
  return text;
}

std::string Output::table() const {
  if (items_.empty()) return {};
  std::vector<std::string> names;  // columns in order of first appearance
  for (const Item& item : items_)
    for (const Item::Field& field : item.fields())
      if (!isHidden(field) && std::find(names.begin(), names.end(), field.key) == names.end())
        names.push_back(field.key);
  std::vector<std::vector<std::string>> cells(items_.size() + 1,
                                              std::vector<std::string>(names.size()));
  std::vector<bool> right(names.size(), false);
  for (std::size_t c = 0; c < names.size(); ++c) {
    cells[0][c] = heading(names[c]);
    for (std::size_t r = 0; r < items_.size(); ++r)
      for (const Item::Field& field : items_[r].fields())
        if (field.key == names[c] && !isHidden(field)) {
          cells[r + 1][c] = toText(field);
          right[c] = isNumber(field.value) && field.text.empty();
        }
  }
  std::string text;
  std::vector<std::size_t> width(names.size(), 0);
  for (const auto& row : cells)
    for (std::size_t c = 0; c < row.size(); ++c) width[c] = std::max(width[c], widthOf(row[c]));
  for (const auto& row : cells) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string pad(width[c] - widthOf(row[c]), ' ');
      line += (c ? "  " : "") + (right[c] ? pad + row[c] : row[c] + pad);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string errorText(Exit exit, const std::string& message, bool json) {
  if (!json) return "patina: " + message + "\n";
  return dump(Json{{"error", {{"exit", static_cast<int>(exit)}, {"message", message}}}}) + "\n";
}

std::string warningText(const std::string& message, bool json) {
  if (!json) return "patina: warning: " + message + "\n";
  return dump(Json{{"warning", {{"message", message}}}}) + "\n";
}

}  // namespace patina::app
