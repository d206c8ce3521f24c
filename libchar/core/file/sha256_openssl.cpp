#include <fmt/format.h>
#include <fmt/ranges.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>

#include <memory>
#include <new>

#include "libchar/core/file/known_digest.hpp"
#include "libchar/core/file/sha256.hpp"

namespace libchar {

struct Sha256::State {
  struct Free {
    void operator()(EVP_MD_CTX* hash) const { EVP_MD_CTX_free(hash); }
  };
  std::unique_ptr<EVP_MD_CTX, Free> context{EVP_MD_CTX_new()};
};

Sha256::Sha256() : state_(detail::hidden<State>()) {
  // OpenSSL has no other reason to refuse this; without its default context, for want of memory, it would crash.
  if (OSSL_LIB_CTX_get0_global_default() == nullptr || !state_->context ||
      EVP_DigestInit_ex(state_->context.get(), EVP_sha256(), nullptr) != 1)
    throw std::bad_alloc();
}

void Sha256::update(std::string_view bytes) { EVP_DigestUpdate(state_->context.get(), bytes.data(), bytes.size()); }

std::string Sha256::finish() {
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int size = 0;
  EVP_DigestFinal_ex(state_->context.get(), digest, &size);
  return fmt::format("{:02x}", fmt::join(digest, digest + size, ""));
}

std::string detail::known_digest(const std::string&) { return ""; }

}  // namespace libchar
