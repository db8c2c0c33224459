// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/seal.h"

#include <openssl/crypto.h>
#include <openssl/hmac.h>
#include <sys/random.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <string_view>

#include "devices/config_file.h"
#include "processing/image/sha256.h"

namespace patina::devices::host {
namespace {

constexpr std::string_view kMagic = "PATINA-HOST/1";
constexpr std::size_t kKeyTextMin = 16, kKeyTextMax = 4096;
constexpr std::uint32_t kGreetingMax = 256;

void append(Bytes& bytes, std::string_view text) {
  const auto more = std::as_bytes(std::span(text.data(), text.size()));
  bytes.insert(bytes.end(), more.begin(), more.end());
}
void append(Bytes& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}

Key hmac(const Key& key, std::span<const std::byte> message) {
  Key out{};
  unsigned length = 0;
  HMAC(EVP_sha256(), key.data(), static_cast<int>(key.size()),
       reinterpret_cast<const unsigned char*>(message.data()), message.size(),
       reinterpret_cast<unsigned char*>(out.data()), &length);
  return out;
}

Result<Key> nonce() {
  Key key{};
  for (std::size_t got = 0; got < key.size();) {
    const ssize_t n = getrandom(key.data() + got, key.size() - got, 0);
    if (n > 0)
      got += static_cast<std::size_t>(n);
    else if (errno != EINTR)
      return fail(Errc::kLost, std::string("no random numbers: ") + std::strerror(errno));
  }
  return key;
}

// What both sides know after the nonces.
struct Meeting {
  Key caller{}, host{};

  Key proof(const Key& key, std::string_view of) const {
    Bytes message;
    append(message, of);
    append(message, caller);
    append(message, host);
    return hmac(key, message);
  }
};

auto stranger() {
  return fail(Errc::kRefused, "the other machine has another shared key: copy the key file there");
}

}  // namespace

Key sealOf(const Key& key, std::uint64_t count, std::span<const std::byte> message) {
  // Twice, so that the message need not be copied behind its count.
  std::array<std::byte, 8> number{};
  for (std::size_t i = 0; i < number.size(); ++i)
    number[i] = static_cast<std::byte>(count >> (8 * i) & 0xff);
  return hmac(hmac(key, number), message);
}

bool sameKey(const Key& a, const Key& b) {
  return CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

Key readKey(const std::filesystem::path& file) {
  const auto reject = [&](const std::string& problem) -> ConfigError {
    return {file, 0, "key", problem};
  };
  struct stat info {};
  if (stat(file.c_str(), &info) != 0) throw reject(std::strerror(errno));
  if ((info.st_mode & 077) != 0) throw reject("others may read it: chmod 600 it");
  const Bytes bytes = readFile(file, kKeyTextMax);
  std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string_view space = " \t\r\n";
  const std::size_t from = text.find_first_not_of(space);
  text = from == std::string_view::npos
             ? std::string_view()
             : text.substr(from, text.find_last_not_of(space) - from + 1);
  if (text.size() < kKeyTextMin)
    throw reject("is shorter than " + std::to_string(kKeyTextMin) +
                 " characters: write one with `openssl rand -hex 32`");
  const Sha256 digest = sha256(std::as_bytes(std::span(text.data(), text.size())));
  Key key{};
  std::memcpy(key.data(), digest.bytes.data(), key.size());
  return key;
}

Result<void> greetAsCaller(Channel& channel, const Key& key, MonoTime deadline) {
  const auto ours = nonce();
  if (!ours) return tl::make_unexpected(ours.error());
  Bytes hello;
  append(hello, kMagic);
  append(hello, *ours);
  if (auto sent = channel.send(hello, deadline); !sent) return sent;
  const auto answer = channel.receive(deadline, kGreetingMax);
  if (!answer) return tl::make_unexpected(answer.error());
  Meeting met{*ours, {}};
  Key proof{};
  if (answer->size() != met.host.size() + proof.size())
    return fail(Errc::kRefused, "the other machine does not speak as `patina device-host` does");
  std::memcpy(met.host.data(), answer->data(), met.host.size());
  std::memcpy(proof.data(), answer->data() + met.host.size(), proof.size());
  if (!sameKey(proof, met.proof(key, "host"))) return stranger();
  if (auto sent = channel.send(met.proof(key, "caller"), deadline); !sent) return sent;
  channel.seal({met.proof(key, "to host"), met.proof(key, "to caller")});
  return {};
}

Result<void> greetAsHost(Channel& channel, const Key& key, MonoTime deadline) {
  const auto hello = channel.receive(deadline, kGreetingMax);
  if (!hello) return tl::make_unexpected(hello.error());
  Meeting met;
  if (hello->size() != kMagic.size() + met.caller.size() ||
      std::memcmp(hello->data(), kMagic.data(), kMagic.size()) != 0)
    return fail(Errc::kRefused, "the caller is no Patina of this protocol");
  std::memcpy(met.caller.data(), hello->data() + kMagic.size(), met.caller.size());
  const auto ours = nonce();
  if (!ours) return tl::make_unexpected(ours.error());
  met.host = *ours;
  Bytes answer;
  append(answer, met.host);
  append(answer, met.proof(key, "host"));
  if (auto sent = channel.send(answer, deadline); !sent) return sent;
  const auto proof = channel.receive(deadline, kGreetingMax);
  if (!proof) return tl::make_unexpected(proof.error());
  Key theirs{};
  if (proof->size() == theirs.size()) std::memcpy(theirs.data(), proof->data(), theirs.size());
  if (!sameKey(theirs, met.proof(key, "caller"))) return stranger();
  channel.seal({met.proof(key, "to caller"), met.proof(key, "to host")});
  return {};
}

}  // namespace patina::devices::host
