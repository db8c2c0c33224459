// SPDX-License-Identifier: GPL-3.0-or-later
#include <curl/curl.h>
#include <gtest/gtest.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <memory>

#include "capture/app/http/private_file.h"
#include "tests/capture/app/http/served.h"

namespace patina::http {
namespace {

using Key = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;

template <class Write>
std::string pemOf(const Write& write) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> bio(BIO_new(BIO_s_mem()), &BIO_free);
  write(bio.get());
  char* text = nullptr;
  const long bytes = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(bytes)};
}

// For 127.0.0.1's own name, signed by itself.
void makeCertificate(const std::filesystem::path& certificate, const std::filesystem::path& key) {
  const Key pair(EVP_EC_gen("P-256"), &EVP_PKEY_free);
  const Certificate made(X509_new(), &X509_free);
  X509_set_version(made.get(), 2);
  ASN1_INTEGER_set(X509_get_serialNumber(made.get()), 1);
  X509_gmtime_adj(X509_getm_notBefore(made.get()), -86400);
  X509_gmtime_adj(X509_getm_notAfter(made.get()), 86400);
  X509_set_pubkey(made.get(), pair.get());
  X509_NAME_add_entry_by_txt(X509_get_subject_name(made.get()), "CN", MBSTRING_ASC,
                             reinterpret_cast<const unsigned char*>("rig.lab"), -1, -1, 0);
  X509_set_issuer_name(made.get(), X509_get_subject_name(made.get()));
  X509_sign(made.get(), pair.get(), EVP_sha256());
  testing::writeFile(certificate, pemOf([&](BIO* to) { PEM_write_bio_X509(to, made.get()); }));
  writePrivateFile(key, pemOf([&](BIO* to) {
                     PEM_write_bio_PrivateKey(to, pair.get(), nullptr, nullptr, 0, nullptr,
                                              nullptr);
                   }));
}

struct TlsReply {
  CURLcode code = CURLE_OK;
  long status = 0;
  std::string body;
};

TlsReply ask(const Served& served, const std::string& scheme, const std::string& trust) {
  TlsReply reply;
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl(curl_easy_init(),
                                                                 &curl_easy_cleanup);
  const std::string port = std::to_string(served.server->port());
  const auto set = [&curl](CURLoption option, auto value) {
    curl_easy_setopt(curl.get(), option, value);
  };
  curl_slist* const resolve =
      curl_slist_append(nullptr, ("rig.lab:" + port + ":127.0.0.1").c_str());
  set(CURLOPT_RESOLVE, resolve);
  set(CURLOPT_URL, (scheme + "://rig.lab:" + port + "/api/v1/status").c_str());
  set(CURLOPT_CAINFO, trust.c_str());
  set(CURLOPT_HTTPAUTH, CURLAUTH_BEARER);
  set(CURLOPT_XOAUTH2_BEARER, served.viewer.c_str());
  set(CURLOPT_NOPROXY, "*");
  set(CURLOPT_WRITEDATA, &reply.body);
  set(
      CURLOPT_WRITEFUNCTION, +[](char* bytes, std::size_t one, std::size_t count, void* to) {
        static_cast<std::string*>(to)->append(bytes, one * count);
        return one * count;
      });
  reply.code = curl_easy_perform(curl.get());
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &reply.status);
  curl_slist_free_all(resolve);
  return reply;
}

TEST(Tls, ServesTheSameRoutesUnderACertificateAndNothingInTheClear) {
  const Served served(stubRoutes(), [](ServerOptions& options) {
    const auto folder = options.archive;
    makeCertificate(folder / "certificate", folder / "key");
    options.tls_certificate = folder / "certificate";
    options.tls_key = folder / "key";
    options.host_names = {"rig.lab"};
  });
  const std::string trust = served.options.tls_certificate.string();
  const TlsReply good = ask(served, "https", trust);
  EXPECT_EQ(good.code, CURLE_OK) << curl_easy_strerror(good.code);
  EXPECT_EQ(good.status, 200);
  EXPECT_EQ(good.body, "{\"did\":\"getStatus\",\"body_bytes\":0}");
  EXPECT_NE(ask(served, "http", trust).status, 200);
  EXPECT_TRUE(served.server->newLink(Role::kViewer).starts_with("https://rig.lab:"));
  EXPECT_EQ(served.local().ask(served.request("GET", "/api/v1/status")).status, 200);
}

TEST(Tls, SaysThatCertificateAndKeyDoNotBelongTogether) {
  EXPECT_THROW(Served(stubRoutes(),
                      [](ServerOptions& options) {
                        const auto folder = options.archive;
                        makeCertificate(folder / "certificate", folder / "other");
                        makeCertificate(folder / "unused", folder / "key");
                        options.tls_certificate = folder / "certificate";
                        options.tls_key = folder / "key";
                      }),
               HttpError);
}

}  // namespace
}  // namespace patina::http
