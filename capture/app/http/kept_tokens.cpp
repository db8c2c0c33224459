// SPDX-License-Identifier: GPL-3.0-or-later
// The file of named tokens: hashes, never tokens.

#include <algorithm>
#include <sstream>

#include "capture/app/http/credentials.h"
#include "capture/app/http/private_file.h"

namespace patina::http {
namespace {

constexpr std::size_t kFileBytesMax = 64 << 10;

KeptToken parseLine(const std::string& line, const std::string& where) {
  std::istringstream words(line);
  KeptToken token;
  std::string role, digest, rest;
  words >> token.name >> role >> digest;
  token.role = roleFromName(role);
  const bool whole = isTokenName(token.name) && token.role != Role::kPublic &&
                     digest.size() == 64 && !(words >> rest);
  try {
    if (whole) {
      token.digest = Sha256::fromHex(digest);
      return token;
    }
  } catch (const ProcessingError&) {
  }
  throw HttpError(Exit::kConfig, where + ": not a line \"NAME ROLE SHA256\": remove it");
}

}  // namespace

bool isTokenName(const std::string& name) {
  return !name.empty() && name.size() <= 64 && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '.' || c == '_' || c == '-';
         });
}

std::vector<KeptToken> readKeptTokens(const std::filesystem::path& file) {
  return parseKeptTokens(readPrivateFile(file, kFileBytesMax).value_or(""), file.string());
}

std::vector<KeptToken> parseKeptTokens(const std::string& text, const std::string& source) {
  std::vector<KeptToken> tokens;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number)
    tokens.push_back(parseLine(line, source + ":" + std::to_string(number)));
  return tokens;
}

void writeKeptTokens(const std::filesystem::path& file, const std::vector<KeptToken>& tokens) {
  std::string text;
  for (const KeptToken& token : tokens)
    text += token.name + " " + roleName(token.role) + " " + token.digest.hex() + "\n";
  writePrivateFile(file, text);
}

std::string addKeptToken(const std::filesystem::path& file, const std::string& name, Role role) {
  devices::RealClock clock;
  return Credentials(clock, file).addNamedToken(name, role);
}

}  // namespace patina::http
