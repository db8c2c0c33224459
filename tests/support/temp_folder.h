// SPDX-License-Identifier: GPL-3.0-or-later
// A folder of its own for one test, gone with the object. Never a fixed name, so tests run side by
// side.
#pragma once

#include <filesystem>
#include <string>

namespace patina::testing {

class TempFolder {
 public:
  TempFolder();                  // beside the test program: a real disk, with a real fsync
  static TempFolder inMemory();  // tmpfs where the machine has one, for tests of many small files
  ~TempFolder();
  TempFolder(TempFolder&& other) noexcept;
  TempFolder& operator=(TempFolder&&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::filesystem::path& name) const { return path_ / name; }

 private:
  explicit TempFolder(const std::filesystem::path& parent);
  std::filesystem::path path_;
};

// Whole files, for planting inputs and reading results. They throw std::system_error.
void writeFile(const std::filesystem::path& file, const std::string& bytes);
std::string readFile(const std::filesystem::path& file);

}  // namespace patina::testing
