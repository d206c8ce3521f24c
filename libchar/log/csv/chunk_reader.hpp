#pragma once
// The bytes of a CSV file, unpacked where it is compressed, cut into chunks of whole lines, and the
// SHA-256 of the file as it is stored.

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/file/sha256.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/unpacker.hpp"

namespace libchar::csv {

/// A run of whole lines with kPadding readable bytes behind it, and the part of `bytes` that was fresh from the file.
struct RawChunk {
  std::vector<char> bytes;
  std::size_t size = 0;      ///< of the lines
  std::uint64_t offset = 0;  ///< in the file
  std::size_t hash_from = 0, hash_to = 0;
  std::uint64_t nuls_after = 0;  ///< NUL bytes that were read behind it and dropped
  bool last = false;
  std::string_view text() const { return {bytes.data(), size}; }
};

/// Reads with read(2), never by mapping: a file that shrinks while it is read must not kill the
/// program. Not thread-safe.
class ChunkReader {
 public:
  ChunkReader(std::string path, std::size_t block_bytes, bool hash);
  /// Of text that comes from elsewhere, whose file somebody else reads and hashes.
  ChunkReader(std::unique_ptr<Unpacker> text, std::string name, std::size_t block_bytes);
  ChunkReader(const ChunkReader&) = delete;
  ChunkReader& operator=(const ChunkReader&) = delete;
  ~ChunkReader();

  /// The first bytes (up to kHeadBytes); `whole` when that is all.
  std::string_view head();
  bool whole() const { return ended_; }
  /// Chunks start where its rows do.
  void start(const Dialect& dialect) {
    dialect_ = &dialect;
    taken_ = offset_ = dialect.data_offset;
  }
  /// The next chunk; false when there is none.
  bool next(RawChunk& chunk);
  /// Chunks in their order, each once, whatever `next` said of it. Another thread may read the next one meanwhile.
  void hash(const RawChunk& chunk);
  /// Reads on to the end of a regular file for its hash; "" when a pipe was not read to its end or
  /// no hash was asked for.
  std::string finish_hash();

  std::uint64_t size() const { return size_; }  ///< as stored; 0 when unknown
  std::string_view packing() const { return unpacker_->what(); }
  bool packed() const { return unpacker_ != nullptr; }
  bool made() const { return packed() && unpacker_->made(); }
  bool headed() const { return packed() && unpacker_->headed(); }
  std::string_view row_name() const { return unpacker_->row_name(); }
  std::string_view format() const { return packed() ? unpacker_->format() : "csv"; }
  void finish(Findings& findings) const {
    if (packed()) unpacker_->finish(findings);
  }
  bool packed_cut() const { return packed() && unpacker_->cut(); }
  std::uint64_t stored_read() const { return stored_; }  ///< bytes of a compressed file
  std::uint64_t bytes_read() const { return read_; }
  std::uint64_t nul_tail() const { return nuls_; }        ///< NUL bytes at the end of the file (after the last chunk)
  std::uint64_t cut_bytes() const { return cut_bytes_; }  ///< of a last line that ran into them and was dropped

 private:
  std::size_t fill(char* to, std::size_t n, std::size_t& from_head);
  std::size_t read_some(char* to, std::size_t n);
  std::size_t read_file(char* to, std::size_t n);
  std::size_t read_stored(char* to, std::size_t n);
  void look_for_packing();
  void refuse_bomb(std::uint64_t text) const;
  void drop_cut_line(RawChunk& chunk);
  void drop_nul_tail(RawChunk& chunk);

  std::string path_;
  std::size_t block_;
  int descriptor_ = -1;
  const Dialect* dialect_ = nullptr;
  bool regular_ = false, ended_ = false, done_ = false;
  std::uint64_t size_ = 0, read_ = 0, offset_ = 0, nuls_ = 0, cut_bytes_ = 0;
  std::string head_;
  std::size_t taken_ = 0;    // of the head
  std::vector<char> carry_;  // an unfinished line
  struct {
    std::string known;          // somebody else took it
    std::optional<Sha256> sha;  // none: not asked for, or known
  } digest_;
  std::string front_;  // bytes that were looked at and not yet given out
  bool file_ended_ = false;
  std::atomic<std::uint64_t> stored_ = 0;
  std::unique_ptr<Unpacker> unpacker_;
};

}  // namespace libchar::csv
