#pragma once
#include <string>
#include <string_view>

#include "libchar/core/hidden.hpp"

namespace libchar {

/// SHA-256 of a stream of bytes: the same digest as sha256sum prints. By OpenSSL (sha256_openssl.cpp), or without it,
/// in a web page, in C++ (sha256_portable.cpp).
class Sha256 {
 public:
  Sha256();
  void update(std::string_view bytes);
  /// 64 lower-case hexadecimal digits. Ends the stream.
  std::string finish();

 private:
  struct State;
  detail::Hidden<State> state_;
};

}  // namespace libchar
