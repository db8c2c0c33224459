// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/config_file.h"

#include <toml++/toml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>

#include "devices/config_guard.h"

namespace patina::devices {
namespace {

std::string errorLine(const std::filesystem::path& file, int line, const std::string& key,
                      const std::string& problem) {
  std::string text = file.string();
  if (line > 0) text += ":" + std::to_string(line);
  text += ": ";
  if (!key.empty()) text += key + ": ";
  text += problem;
  // Whatever came in with a path or a key: one line on a terminal.
  std::replace_if(
      text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7F; }, ' ');
  return text;
}

std::string numberText(double value) {
  char buffer[32];
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

const char* typeName(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::table:
      return "a table";
    case toml::node_type::array:
      return "a list";
    case toml::node_type::string:
      return "text";
    case toml::node_type::integer:
      return "a whole number";
    case toml::node_type::floating_point:
      return "a decimal number";
    case toml::node_type::boolean:
      return "true or false";
    default:
      return "a date or time";
  }
}

std::string scalarText(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* number = node.as_floating_point()) return numberText(number->get());
  if (const auto* number = node.as_integer()) return std::to_string(number->get());
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  std::ostringstream text;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_chronological<decltype(value)>) text << value.get();
  });
  return text.str();
}

template <class T>
std::string joined(const std::vector<T>& words) {
  std::string text;
  for (const T& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace

ConfigError::ConfigError(const std::filesystem::path& file, int line, const std::string& key,
                         const std::string& problem)
    : Failure(Exit::kConfig, errorLine(file, line, key, problem)), line_(line) {}

struct ConfigTable::Node {
  std::filesystem::path source;
  std::shared_ptr<const toml::table> root;  // keeps `table` alive
  const toml::table* table = nullptr;
  std::string path;                        // "sweep." of a table [[sweep]], "" of the root
  mutable std::vector<std::string> asked;  // in order

  const toml::node* find(const std::string& key) const {
    if (std::find(asked.begin(), asked.end(), key) == asked.end()) asked.push_back(key);
    return table->get(key);
  }
  int lineOf(const std::string& key) const {
    const auto found = table->find(key);
    const auto& region = found == table->end() ? table->source() : found->first.source();
    return std::max(1, static_cast<int>(region.begin.line));
  }
  ConfigTable child(const toml::table& inner, const std::string& key) const {
    return ConfigTable(
        std::make_shared<Node>(Node{source, root, &inner, path + quoteForMessage(key) + ".", {}}));
  }
  [[noreturn]] void reject(const std::string& key, const std::string& problem) const {
    throw ConfigError(source, lineOf(key), path + quoteForMessage(key), problem);
  }
  [[noreturn]] void rejectType(const std::string& key, const toml::node& found,
                               const std::string& wanted) const {
    reject(key, std::string("is ") + typeName(found) + ", but must be " + wanted);
  }
  // Nothing when the key is absent and there is something to fall back on.
  template <class T>
  const toml::node* need(const std::string& key, const std::optional<T>& fallback,
                         const std::string& wanted) const {
    const toml::node* node = find(key);
    if (!node && !fallback) reject(key, "is missing; must be " + wanted);
    return node;
  }
  const std::string& text(const std::string& key, const toml::node& node,
                          const std::string& wanted) const {
    const auto* value = node.as_string();
    if (!value) rejectType(key, node, wanted);
    if (value->get().find('\0') != std::string::npos) reject(key, "holds a NUL character");
    return value->get();
  }
  std::vector<std::string> texts(const std::string& key, const toml::node& node,
                                 const std::string& wanted) const {
    const auto* list = node.as_array();
    if (!list) rejectType(key, node, wanted);
    std::vector<std::string> values;
    for (const toml::node& element : *list) values.push_back(text(key, element, wanted));
    return values;
  }
  template <class Parse>
  Nanoseconds time(const std::string& key, Nanoseconds least, Nanoseconds most,
                   std::optional<Nanoseconds> fallback, const std::string& wanted,
                   std::string (*format)(Nanoseconds), Parse parse) const {
    const std::string range = " (" + format(least) + " to " + format(most) + ")";
    const toml::node* node = need(key, fallback, wanted + range);
    if (!node) return *fallback;
    const std::string& value = text(key, *node, wanted + range);
    Nanoseconds parsed{};
    try {
      parsed = parse(value);
    } catch (const Failure&) {
      reject(key, '"' + quoteForMessage(value) + "\" is not " + wanted + range);
    }
    if (parsed < least || parsed > most) {
      reject(key, quoteForMessage(value) + " is out of range" + range);
    }
    return parsed;
  }
};

ConfigTable::ConfigTable(std::shared_ptr<Node> node) : node_(std::move(node)) {}

std::string ConfigTable::takeString(const std::string& key, std::optional<std::string> fallback) {
  const toml::node* node = node_->need(key, fallback, "text in quotes");
  return node ? node_->text(key, *node, "text in quotes") : *fallback;
}

std::string ConfigTable::takeId(const std::string& key) {
  const std::string id = takeString(key);
  const bool letters = std::all_of(id.begin(), id.end(), [](unsigned char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  if (!letters || id.empty() || id.size() > 32) {
    reject(key, '"' + quoteForMessage(id) + "\" is no id (1 to 32 of a-z 0-9 _ -)");
  }
  return id;
}

std::string ConfigTable::takeChoice(const std::string& key, const std::vector<std::string>& choices,
                                    std::optional<std::string> fallback) {
  const std::string wanted = "one of " + joined(choices);
  const toml::node* node = node_->need(key, fallback, wanted);
  if (!node) return *fallback;
  const std::string& value = node_->text(key, *node, wanted);
  if (std::find(choices.begin(), choices.end(), value) == choices.end()) {
    const std::string nearest = nearestWord(value, choices);
    reject(key, '"' + quoteForMessage(value) + "\" is not " + wanted +
                    (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
  }
  return value;
}

std::int64_t ConfigTable::takeInteger(const std::string& key, std::int64_t least, std::int64_t most,
                                      std::optional<std::int64_t> fallback) {
  const std::string range = " (" + std::to_string(least) + " to " + std::to_string(most) + ")";
  const toml::node* node = node_->need(key, fallback, "a whole number" + range);
  if (!node) return *fallback;
  const auto* value = node->as_integer();
  if (!value) node_->rejectType(key, *node, "a whole number" + range);
  if (value->get() < least || value->get() > most) {
    reject(key, std::to_string(value->get()) + " is out of range" + range);
  }
  return value->get();
}

double ConfigTable::takeNumber(const std::string& key, double least, double most,
                               std::optional<double> fallback) {
  const std::string range = " (" + numberText(least) + " to " + numberText(most) + ")";
  const toml::node* node = node_->need(key, fallback, "a number" + range);
  if (!node) return *fallback;
  if (!node->is_number()) node_->rejectType(key, *node, "a number" + range);
  const double value = *node->value<double>();
  if (!(value >= least && value <= most)) {
    reject(key, numberText(value) + " is out of range" + range);
  }
  return value;
}

bool ConfigTable::takeBool(const std::string& key, std::optional<bool> fallback) {
  const toml::node* node = node_->need(key, fallback, "true or false");
  if (!node) return *fallback;
  const auto* value = node->as_boolean();
  if (!value) node_->rejectType(key, *node, "true or false");
  return value->get();
}

Nanoseconds ConfigTable::takeDuration(const std::string& key, Nanoseconds least, Nanoseconds most,
                                      std::optional<Nanoseconds> fallback) {
  return node_->time(key, least, most, fallback, "a duration such as \"10min\" or \"36h\"",
                     formatDuration, [](const std::string& text) { return parseDuration(text); });
}

Nanoseconds ConfigTable::takeExposure(const std::string& key, Nanoseconds least, Nanoseconds most,
                                      std::optional<Nanoseconds> fallback) {
  return node_->time(key, least, most, fallback, "an exposure such as \"1/100\" or \"0.5s\"",
                     formatExposure, [](const std::string& text) { return parseExposure(text); });
}

SizePx ConfigTable::takeSize(const std::string& key, int least, int most,
                             std::optional<SizePx> fallback) {
  const std::string wanted = "a size such as \"512x512\" (" + std::to_string(least) + " to " +
                             std::to_string(most) + " px a side)";
  const toml::node* node = node_->need(key, fallback, wanted);
  if (!node) return *fallback;
  const std::string& value = node_->text(key, *node, wanted);
  SizePx size;
  try {
    size = parseSize(value);
  } catch (const Failure&) {
    reject(key, '"' + quoteForMessage(value) + "\" is not " + wanted);
  }
  if (std::min(size.width, size.height) < least || std::max(size.width, size.height) > most) {
    reject(key, quoteForMessage(value) + " is out of range; must be " + wanted);
  }
  return size;
}

std::filesystem::path ConfigTable::takePath(const std::string& key,
                                            std::optional<std::filesystem::path> fallback) {
  const toml::node* node = node_->need(key, fallback, "a path in quotes");
  if (!node) return *fallback;
  const std::filesystem::path path = node_->text(key, *node, "a path in quotes");
  if (path.empty()) reject(key, "is empty; must be a path");
  return path.is_absolute() ? path : (source().parent_path() / path).lexically_normal();
}

std::vector<std::string> ConfigTable::takeStrings(
    const std::string& key, std::optional<std::vector<std::string>> fallback) {
  const std::string wanted = "a list of texts, as [\"a\", \"b\"]";
  const toml::node* node = node_->need(key, fallback, wanted);
  return node ? node_->texts(key, *node, wanted) : *fallback;
}

std::vector<std::vector<std::string>> ConfigTable::takeStringLists(const std::string& key) {
  const std::string wanted = "a list of lists of texts, as [[], [\"a\"], [\"a\", \"b\"]]";
  const toml::node* node = node_->need(key, std::optional<int>(), wanted);
  const auto* list = node->as_array();
  if (!list) node_->rejectType(key, *node, wanted);
  std::vector<std::vector<std::string>> lists;
  for (const toml::node& element : *list) lists.push_back(node_->texts(key, element, wanted));
  return lists;
}

std::vector<double> ConfigTable::takeNumbers(const std::string& key, std::size_t count,
                                             std::optional<std::vector<double>> fallback) {
  const std::string wanted =
      "a list of " + (count == 0 ? "" : std::to_string(count) + " ") + "numbers";
  const toml::node* node = node_->need(key, fallback, wanted);
  if (!node) return *fallback;
  const auto* list = node->as_array();
  if (!list) node_->rejectType(key, *node, wanted);
  std::vector<double> numbers;
  for (const toml::node& element : *list) {
    if (!element.is_number()) node_->rejectType(key, element, wanted);
    numbers.push_back(*element.value<double>());
    if (!std::isfinite(numbers.back())) reject(key, "holds a number that is not finite");
  }
  if (count != 0 && numbers.size() != count) {
    reject(key, "has " + std::to_string(numbers.size()) + " numbers; must be " + wanted);
  }
  return numbers;
}

std::optional<ConfigTable> ConfigTable::takeTable(const std::string& key) {
  const toml::node* node = node_->find(key);
  if (!node) return std::nullopt;
  const auto* table = node->as_table();
  if (!table) node_->rejectType(key, *node, "one table [" + quoteForMessage(key) + "]");
  return node_->child(*table, key);
}

std::vector<ConfigTable> ConfigTable::takeTables(const std::string& key) {
  const std::string wanted = "tables [[" + quoteForMessage(key) + "]]";
  const toml::node* node = node_->find(key);
  std::vector<ConfigTable> tables;
  if (!node) return tables;
  if (const auto* table = node->as_table()) return {node_->child(*table, key)};
  const auto* list = node->as_array();
  if (!list) node_->rejectType(key, *node, wanted);
  for (const toml::node& element : *list) {
    if (!element.is_table()) node_->rejectType(key, element, wanted);
    tables.push_back(node_->child(*element.as_table(), key));
  }
  return tables;
}

std::vector<std::pair<std::string, std::string>> ConfigTable::takeRest() {
  std::vector<std::pair<std::string, std::string>> rest;
  for (const auto& [key, node] : *node_->table) {
    const std::string name(key.str());
    if (std::find(node_->asked.begin(), node_->asked.end(), name) != node_->asked.end()) continue;
    node_->asked.push_back(name);
    if (node.is_table() || node.is_array()) node_->rejectType(name, node, "a single value");
    rest.emplace_back(name, scalarText(node));
  }
  return rest;
}

bool ConfigTable::has(const std::string& key) const { return node_->find(key) != nullptr; }

int ConfigTable::line(const std::string& key) const { return node_->lineOf(key); }

const std::filesystem::path& ConfigTable::source() const { return node_->source; }

void ConfigTable::reject(const std::string& key, const std::string& problem) const {
  node_->reject(key, problem);
}

void ConfigTable::finish() const {
  const std::vector<std::string>& known = node_->asked;
  const toml::key* first = nullptr;
  for (const auto& [key, node] : *node_->table) {
    if (std::find(known.begin(), known.end(), key.str()) != known.end()) continue;
    if (!first || key.source().begin.line < first->source().begin.line) first = &key;
  }
  if (!first) return;
  const std::string nearest = nearestWord(std::string(first->str()), known);
  reject(std::string(first->str()),
         "is no known key" + (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?") +
             " (known: " + joined(known) + ")");
}

ConfigTable ConfigFile::parse(const std::string& toml, const std::filesystem::path& source) {
  guardConfigText(toml, source);
  try {
    auto root = std::make_shared<const toml::table>(toml::parse(std::string_view(toml)));
    const toml::table* table = root.get();
    return ConfigTable(std::make_shared<ConfigTable::Node>(
        ConfigTable::Node{source, std::move(root), table, "", {}}));
  } catch (const toml::parse_error& error) {
    throw ConfigError(source, static_cast<int>(error.source().begin.line), "",
                      std::string(error.description()));
  }
}

std::string ConfigFile::readText(const std::filesystem::path& file) {
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::string text(kConfigBytesMax + 1, '\0');
  if (in) in.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!in.is_open() || in.bad() || (in.gcount() == 0 && !in.eof())) {
    throw Failure(errno == EACCES ? Exit::kPermission : Exit::kIo,
                  errorLine(file, 0, "", std::string("cannot be read: ") + std::strerror(errno)));
  }
  text.resize(static_cast<std::size_t>(in.gcount()));
  return text;
}

ConfigTable ConfigFile::read(const std::filesystem::path& file) {
  return parse(readText(file), file);
}

}  // namespace patina::devices
