// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/credentials.h"

#include <openssl/crypto.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <chrono>

namespace patina::http {
namespace {

constexpr std::size_t kTicketsMax = 16, kSessionsMax = 64, kNamedMax = 64;
constexpr std::size_t kAttemptsMax = 5, kPeersMax = 256;
constexpr std::chrono::minutes kTicketLife{10}, kAttemptWindow{1};
constexpr std::chrono::days kSessionLife{30};
constexpr MonoTime kNever = MonoTime::max();

}  // namespace

std::string newToken() {
  Sha256 random;  // 32 bytes that print as 64 digits
  std::size_t got = 0;
  while (got < random.bytes.size()) {
    const ssize_t n = getrandom(random.bytes.data() + got, random.bytes.size() - got, 0);
    if (n > 0) got += static_cast<std::size_t>(n);
  }
  return random.hex();
}

bool sameDigest(const Sha256& a, const Sha256& b) {
  return CRYPTO_memcmp(a.bytes.data(), b.bytes.data(), a.bytes.size()) == 0;
}

Credentials::Credentials(devices::Clock& clock, std::filesystem::path kept)
    : clock_(clock), kept_file_(std::move(kept)) {
  if (!kept_file_.empty()) kept_ = readKeptTokens(kept_file_);
}

std::string Credentials::addProcessToken(Role role) {
  const std::lock_guard lock(mutex_);
  std::string token = newToken();
  process_.push_back({sha256(token), role, kNever});
  return token;
}

std::string Credentials::addNamedToken(const std::string& name, Role role) {
  const std::lock_guard lock(mutex_);
  if (!isTokenName(name) || role == Role::kPublic)
    throw HttpError(Exit::kUsage,
                    "a token needs a name of letters, digits, '.', '_' and '-', and a role: "
                    "viewer, operator or admin");
  if (std::any_of(kept_.begin(), kept_.end(), [&](const KeptToken& k) { return k.name == name; }))
    throw HttpError(Exit::kUsage, "a token '" + name + "' exists: remove it first");
  if (kept_.size() == kNamedMax)
    throw HttpError(Exit::kUsage, "there are 64 tokens: remove one first");
  std::string token = newToken();
  auto kept = kept_;
  kept.push_back({name, role, sha256(token)});
  if (!kept_file_.empty()) writeKeptTokens(kept_file_, kept);
  kept_ = std::move(kept);
  return token;
}

bool Credentials::removeNamedToken(const std::string& name) {
  const std::lock_guard lock(mutex_);
  auto kept = kept_;
  if (std::erase_if(kept, [&](const KeptToken& k) { return k.name == name; }) == 0) return false;
  if (!kept_file_.empty()) writeKeptTokens(kept_file_, kept);
  kept_ = std::move(kept);
  return true;
}

bool Credentials::hasNamedToken() const {
  const std::lock_guard lock(mutex_);
  return !kept_.empty();
}

// Every entry is compared, so that the time does not tell which one came near.
Role Credentials::roleIn(const std::vector<Timed>& list, const std::string& token, MonoTime now) {
  const Sha256 digest = sha256(token);
  Role role = Role::kPublic;
  for (const Timed& one : list)
    if (sameDigest(one.digest, digest) && now < one.ends) role = one.role;
  return role;
}

Role Credentials::roleOfBearer(const std::string& token) const {
  const std::lock_guard lock(mutex_);
  Role role = roleIn(process_, token, clock_.mono());
  const Sha256 digest = sha256(token);
  for (const KeptToken& one : kept_)
    if (sameDigest(one.digest, digest)) role = one.role;
  return role;
}

Role Credentials::roleOfSession(const std::string& token) const {
  const std::lock_guard lock(mutex_);
  return roleIn(sessions_, token, clock_.mono());
}

void Credentials::dropEnded(std::vector<Timed>& list, std::size_t most) {
  const MonoTime now = clock_.mono();
  std::erase_if(list, [now](const Timed& one) { return now >= one.ends; });
  if (list.size() >= most) list.erase(list.begin());
}

std::string Credentials::newTicket(Role role) {
  const std::lock_guard lock(mutex_);
  dropEnded(tickets_, kTicketsMax);
  std::string ticket = newToken();
  tickets_.push_back({sha256(ticket), role, clock_.mono() + kTicketLife});
  return ticket;
}

std::optional<std::string> Credentials::exchangeTicket(const std::string& ticket) {
  const std::lock_guard lock(mutex_);
  const Role role = roleIn(tickets_, ticket, clock_.mono());
  if (role == Role::kPublic) return std::nullopt;
  std::erase_if(tickets_, [digest = sha256(ticket)](const Timed& one) {
    return sameDigest(one.digest, digest);
  });
  dropEnded(sessions_, kSessionsMax);
  std::string session = newToken();
  sessions_.push_back({sha256(session), role, clock_.mono() + kSessionLife});
  return session;
}

bool Credentials::mayTryToLogIn(const std::string& peer) {
  const std::lock_guard lock(mutex_);
  const MonoTime now = clock_.mono();
  for (auto& [name, times] : attempts_)
    std::erase_if(times, [now](MonoTime t) { return now - t >= kAttemptWindow; });
  std::erase_if(attempts_, [](const auto& entry) { return entry.second.empty(); });
  // A crowd of addresses shares one count, so that it cannot fill the memory.
  auto& times = attempts_[attempts_.size() < kPeersMax ? peer : "others"];
  if (times.size() >= kAttemptsMax) return false;
  times.push_back(now);
  return true;
}

}  // namespace patina::http
