// SPDX-License-Identifier: GPL-3.0-or-later
// Who may come in: bearer tokens, one-time tokens and the sessions of browsers. A token is 256 bits
// of getrandom(2) in hexadecimal; once given out, only its SHA-256 is kept. Thread-safe.
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/app/http/messages.h"
#include "devices/clock.h"
#include "processing/image/sha256.h"

namespace patina::http {

std::string newToken();  // 64 hexadecimal digits
// In a time that tells nothing of where they differ.
bool sameDigest(const Sha256& a, const Sha256& b);

// A bearer token that was given a name, for a scraper or a script.
struct KeptToken {
  std::string name;
  Role role = Role::kPublic;
  Sha256 digest;
};
bool isTokenName(const std::string& name);  // 1 to 64 of [A-Za-z0-9._-], no leading dot
// A file of lines "NAME ROLE SHA256". A file that is not there holds none; one that others may read
// or write, or that does not parse, is HttpError(kConfig).
std::vector<KeptToken> readKeptTokens(const std::filesystem::path& file);
std::vector<KeptToken> parseKeptTokens(const std::string& text, const std::string& source);
// Whole or not at all, mode 0600.
void writeKeptTokens(const std::filesystem::path& file, const std::vector<KeptToken>& tokens);
// Adds a token to the file, without a server, and gives it, this once. HttpError(kUsage) when the
// name is taken or no name.
std::string addKeptToken(const std::filesystem::path& file, const std::string& name, Role role);

class Credentials {
 public:
  // `kept` may be empty: then named tokens live as long as the process.
  Credentials(devices::Clock& clock, std::filesystem::path kept);

  // A token of this process alone: what is written beside the socket.
  std::string addProcessToken(Role role);
  std::string addNamedToken(const std::string& name, Role role);  // as addKeptToken
  bool removeNamedToken(const std::string& name);                 // false: there was none
  bool hasNamedToken() const;

  // kPublic: nobody we know.
  Role roleOfBearer(const std::string& token) const;
  Role roleOfSession(const std::string& token) const;

  // Good once, for ten minutes. At most 16 wait; the oldest gives way.
  std::string newTicket(Role role);
  // Takes the ticket and gives the token of a session of its role, good for thirty days, at most
  // 64 at a time.
  std::optional<std::string> exchangeTicket(const std::string& ticket);
  // At most five attempts a minute and peer, good or bad. Counts this one.
  bool mayTryToLogIn(const std::string& peer);

 private:
  struct Timed {
    Sha256 digest;
    Role role;
    MonoTime ends;
  };
  static Role roleIn(const std::vector<Timed>& list, const std::string& token, MonoTime now);
  void dropEnded(std::vector<Timed>& list, std::size_t most);

  devices::Clock& clock_;
  std::filesystem::path kept_file_;
  mutable std::mutex mutex_;
  std::vector<KeptToken> kept_;
  std::vector<Timed> process_, tickets_, sessions_;
  std::map<std::string, std::vector<MonoTime>> attempts_;  // of the last minute
};

}  // namespace patina::http
