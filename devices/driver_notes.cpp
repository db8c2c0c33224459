// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/driver_notes.h"

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace patina::devices {
namespace {

std::optional<std::filesystem::path> fileOf(std::string name) {
  const char* folder = std::getenv(kDriverNotes);
  if (!folder || *folder == '\0') return std::nullopt;
  for (char& c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
  return std::filesystem::path(folder) / (name + ".note");
}

}  // namespace

std::optional<std::string> driverNote(const std::string& name) {
  const auto file = fileOf(name);
  if (!file) return std::nullopt;
  std::ifstream in(*file, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

void noteForDriver(const std::string& name, const std::string& text) {
  const auto file = fileOf(name);
  if (!file) return;
  std::filesystem::path unfinished = *file;
  unfinished += ".new";
  std::ofstream out(unfinished, std::ios::binary);
  out << text;
  out.close();
  std::error_code ignored;
  if (out) std::filesystem::rename(unfinished, *file, ignored);
}

}  // namespace patina::devices
