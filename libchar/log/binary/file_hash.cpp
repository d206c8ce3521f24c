#include "libchar/log/binary/file_hash.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <system_error>
#include <vector>

#include "libchar/core/file/sha256.hpp"

namespace libchar {

FileHash::~FileHash() {
  stop_ = true;
  if (hashing_.valid()) hashing_.wait();
}

void FileHash::start() {
  if (!wanted_ || hashing_.valid() || !digest_.empty()) return;
  const auto hash = [this] { return digest_of_files(); };
  try {
    hashing_ = std::async(std::launch::async, hash);
  } catch (const std::system_error&) {  // no thread is to be had: afterwards, then
    hashing_ = std::async(std::launch::deferred, hash);
  }
}

std::string FileHash::finish() {
  start();
  if (hashing_.valid()) digest_ = hashing_.get();
  return digest_;
}

std::string FileHash::digest_of_files() const {
  Sha256 sha;
  std::vector<std::byte> piece(std::size_t{1} << 20U);
  for (const BinaryFile* file : files_)
    for (std::uint64_t at = 0; at < file->size() && !stop_;) {
      const auto n =
          static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), file->size() - at));
      file->read(at, std::span(piece).first(n));
      sha.update({reinterpret_cast<const char*>(piece.data()), n});
      at += n;
    }
  return sha.finish();
}

}  // namespace libchar
