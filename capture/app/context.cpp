// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/context.h"

#include <cstdio>
#include <cstring>

namespace patina::app {

void refuseThatIsThere(std::initializer_list<std::string> outputs) {
  for (const std::string& out : outputs)
    if (!out.empty() && std::filesystem::exists(out))
      throw AppError(Exit::kCannotCreate, out + " is there already");
}

const std::filesystem::path& Context::archive() const {
  if (options.archive.empty())
    throw AppError(Exit::kUsage, "which archive? Give --archive DIR or set PATINA_ARCHIVE");
  return options.archive;
}

void Context::warn(const std::string& message) const {
  if (options.quiet) return;
  progress.clear();
  std::fputs(warningText(message, options.json).c_str(), stderr);
}

void Context::verbose(const std::string& message) const {
  if (!options.verbose || options.quiet) return;
  progress.clear();
  std::fprintf(stderr, "%s\n", message.c_str());
}

std::string quoted(int argc, char** argv) {
  std::string line = "patina";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool plain =
        !word.empty() && word.find_first_not_of(
                             "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                             "_-+=.,:/@%") == std::string::npos;
    line += ' ';
    if (plain) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

}  // namespace patina::app
