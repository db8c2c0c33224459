// SPDX-License-Identifier: GPL-3.0-or-later
// Guarded TOML: what a plan, a rig and a faults file have in common. Unknown key, wrong type, wrong
// unit, out of range: one line with file, line, key and the allowed range.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processing/image/failure.h"
#include "processing/image/units.h"

namespace patina::devices {

// "plan.toml:7: interval: 0s is out of range (50ms to 400d)". Exit kConfig. One line whatever the
// file holds: control characters are escaped, long values cut. Line 0 and key "" are left out.
class ConfigError : public Failure {
 public:
  ConfigError(const std::filesystem::path& file, int line, const std::string& key,
              const std::string& problem);
  int line() const { return line_; }

 private:
  int line_;
};

// Refused before parsing, since nesting beyond these crashes the parser.
constexpr std::size_t kConfigBytesMax = 64 * 1024;
constexpr int kConfigDotsALineMax = 100;
constexpr std::size_t kConfigBracketsMax = 16;  // arrays and inline tables within each other

// One table of a parsed file. Every take* marks its key as known; finish() throws for the first key
// nobody took, naming the nearest known one and all of them. Missing key without fallback: an error
// at the table's line. Copies share their state. Not thread-safe.
class ConfigTable {
 public:
  std::string takeString(const std::string& key, std::optional<std::string> fallback = {});
  // [a-z0-9_-], 1 to 32 characters: it becomes part of file names and light states.
  std::string takeId(const std::string& key);
  std::string takeChoice(const std::string& key, const std::vector<std::string>& choices,
                         std::optional<std::string> fallback = {});
  std::int64_t takeInteger(const std::string& key, std::int64_t least, std::int64_t most,
                           std::optional<std::int64_t> fallback = {});
  double takeNumber(const std::string& key, double least, double most,
                    std::optional<double> fallback = {});
  bool takeBool(const std::string& key, std::optional<bool> fallback = {});
  Nanoseconds takeDuration(const std::string& key, Nanoseconds least, Nanoseconds most,
                           std::optional<Nanoseconds> fallback = {});
  Nanoseconds takeExposure(const std::string& key, Nanoseconds least, Nanoseconds most,
                           std::optional<Nanoseconds> fallback = {});
  SizePx takeSize(const std::string& key, int least, int most, std::optional<SizePx> fallback = {});
  // Relative paths start at the file's own folder. It need not exist.
  std::filesystem::path takePath(const std::string& key,
                                 std::optional<std::filesystem::path> fallback = {});
  std::vector<std::string> takeStrings(const std::string& key,
                                       std::optional<std::vector<std::string>> fallback = {});
  std::vector<std::vector<std::string>> takeStringLists(const std::string& key);
  // Finite numbers; `count` of them, 0: any number.
  std::vector<double> takeNumbers(const std::string& key, std::size_t count,
                                  std::optional<std::vector<double>> fallback = {});
  std::optional<ConfigTable> takeTable(const std::string& key);
  // [[key]]; may be empty; a lone [key] counts as one.
  std::vector<ConfigTable> takeTables(const std::string& key);
  // Remaining scalar keys as text: a backend's own settings.
  std::vector<std::pair<std::string, std::string>> takeRest();

  bool has(const std::string& key) const;
  int line(const std::string& key = {}) const;  // of the key, or of the table
  const std::filesystem::path& source() const;
  [[noreturn]] void reject(const std::string& key, const std::string& problem) const;
  void finish() const;

 private:
  friend class ConfigFile;
  struct Node;
  explicit ConfigTable(std::shared_ptr<Node> node);
  std::shared_ptr<Node> node_;
};

class ConfigFile {
 public:
  // Throws ConfigError; Failure(kIo or kPermission) when the file cannot be read.
  static ConfigTable read(const std::filesystem::path& file);
  static ConfigTable parse(const std::string& toml, const std::filesystem::path& source);
  // At most kConfigBytesMax, for callers that keep the text too.
  static std::string readText(const std::filesystem::path& file);
};

}  // namespace patina::devices
