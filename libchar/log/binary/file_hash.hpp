#pragma once
// The digest of a whole file in its own order, taken beside the reading of it, from pages that the system has cached.

#include <atomic>
#include <future>
#include <string>
#include <utility>
#include <vector>

#include "libchar/log/binary/file.hpp"

namespace libchar {

class FileHash {
 public:
  /// The file outlives this. Nothing is hashed unless `wanted`.
  FileHash(const BinaryFile& file, bool wanted) : files_({&file}), wanted_(wanted) {}
  /// Of several files as if they were one.
  FileHash(std::vector<const BinaryFile*> files, bool wanted)
      : files_(std::move(files)), wanted_(wanted) {}
  /// An abandoned reading does not finish the hash of a large file.
  ~FileHash();
  FileHash(const FileHash&) = delete;
  FileHash& operator=(const FileHash&) = delete;

  /// Begins beside the caller, once; a thread that is not to be had means: in `finish`.
  void start();
  /// 64 hexadecimal digits, "" when not wanted. Waits for what is left.
  std::string finish();

 private:
  std::string digest_of_files() const;

  std::vector<const BinaryFile*> files_;
  bool wanted_;
  std::atomic<bool> stop_ = false;
  std::string digest_;
  std::future<std::string> hashing_;
};

}  // namespace libchar
