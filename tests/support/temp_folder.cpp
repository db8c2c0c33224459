// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/temp_folder.h"

#include <stdlib.h>

#include <cerrno>
#include <fstream>
#include <iterator>
#include <system_error>

#include "tests/support/places.h"

namespace fs = std::filesystem;

namespace patina::testing {

namespace {

[[noreturn]] void fail(const std::string& what) {
  throw std::system_error(errno, std::generic_category(), what);
}

}  // namespace

TempFolder::TempFolder() : TempFolder(programFolder() / "scratch") {}

TempFolder TempFolder::inMemory() {
  const fs::path shm = "/dev/shm";
  return fs::is_directory(shm) ? TempFolder(shm) : TempFolder();
}

TempFolder::TempFolder(const fs::path& parent) {
  fs::create_directories(parent);
  std::string name = (parent / "patina-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) fail(name);
  path_ = name;
}

TempFolder::TempFolder(TempFolder&& other) noexcept : path_(std::move(other.path_)) {
  other.path_.clear();
}

TempFolder::~TempFolder() {
  if (path_.empty()) return;
  std::error_code ignored;
  // A test of a read-only archive may leave folders that even their owner cannot empty.
  for (fs::recursive_directory_iterator it(path_, ignored), end; it != end; it.increment(ignored))
    if (it->is_directory(ignored) && !it->is_symlink(ignored))
      fs::permissions(it->path(), fs::perms::owner_all, fs::perm_options::add, ignored);
  fs::remove_all(path_, ignored);
}

void writeFile(const fs::path& file, const std::string& bytes) {
  std::ofstream out(file, std::ios::binary);
  out << bytes;
  out.close();
  if (!out) fail(file.string());
}

std::string readFile(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(file.string());
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace patina::testing
