// SPDX-License-Identifier: GPL-3.0-or-later
// The files of page/ and docs/openapi.json, built into the program.
#pragma once

#include <string>
#include <vector>

namespace patina::http {

struct PageFile {
  std::string path, content_type, text;
};
const std::vector<PageFile>& pageFiles();
const std::string& openApiText();

}  // namespace patina::http
