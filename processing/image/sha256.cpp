// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/sha256.h"

#include <openssl/evp.h>

#include <cstdio>
#include <vector>

#include "processing/image/failure.h"

namespace patina {
namespace {

struct FreeContext {
  void operator()(EVP_MD_CTX* c) const { EVP_MD_CTX_free(c); }
};
struct CloseFile {
  void operator()(std::FILE* f) const { std::fclose(f); }
};

int digitValue(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

}  // namespace

std::string Sha256::hex() const {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string out;
  out.reserve(64);
  for (unsigned char b : bytes) {
    out += kDigits[b >> 4];
    out += kDigits[b & 15];
  }
  return out;
}

Sha256 Sha256::fromHex(std::string_view digits) {
  Sha256 out;
  bool good = digits.size() == 64;
  for (std::size_t i = 0; good && i < 32; ++i) {
    const int high = digitValue(digits[2 * i]), low = digitValue(digits[2 * i + 1]);
    good = high >= 0 && low >= 0;
    out.bytes[i] = static_cast<unsigned char>(high * 16 + low);
  }
  if (!good)
    throw ProcessingError(Exit::kBadData, "not a SHA-256: expected 64 lower-case hex digits");
  return out;
}

struct Sha256Stream::State {
  std::unique_ptr<EVP_MD_CTX, FreeContext> context{EVP_MD_CTX_new()};
};

Sha256Stream::Sha256Stream() : state_(std::make_unique<State>()) {
  // Fetched once: OpenSSL 3 looks the algorithm up on every EVP_sha256() otherwise.
  static const EVP_MD* const algorithm = EVP_MD_fetch(nullptr, "SHA256", nullptr);
  PATINA_CHECK(state_->context && EVP_DigestInit_ex(state_->context.get(), algorithm, nullptr));
}

Sha256Stream::~Sha256Stream() = default;

void Sha256Stream::add(std::span<const std::byte> data) {
  PATINA_CHECK(EVP_DigestUpdate(state_->context.get(), data.data(), data.size()) == 1);
}

Sha256 Sha256Stream::finish() {
  Sha256 out;
  PATINA_CHECK(EVP_DigestFinal_ex(state_->context.get(), out.bytes.data(), nullptr) == 1);
  return out;
}

Sha256 sha256(std::span<const std::byte> data) {
  Sha256Stream stream;
  stream.add(data);
  return stream.finish();
}

Sha256 sha256(std::string_view text) {
  return sha256(std::as_bytes(std::span(text.data(), text.size())));
}

Sha256 sha256OfFile(const std::filesystem::path& path) {
  const std::unique_ptr<std::FILE, CloseFile> file(std::fopen(path.c_str(), "rb"));
  if (!file) throw ProcessingError(Exit::kIo, path.string() + ": cannot be opened for reading");
  Sha256Stream stream;
  std::vector<std::byte> block(1 << 20);
  for (;;) {
    const std::size_t n = std::fread(block.data(), 1, block.size(), file.get());
    if (n > 0) stream.add(std::span(block.data(), n));
    if (n < block.size()) break;
  }
  if (std::ferror(file.get())) throw ProcessingError(Exit::kIo, path.string() + ": cannot be read");
  return stream.finish();
}

}  // namespace patina
