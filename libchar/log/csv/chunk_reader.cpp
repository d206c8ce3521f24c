#include "libchar/log/csv/chunk_reader.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "libchar/core/file/known_digest.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/log/csv/rows/rows.hpp"

namespace libchar::csv {
namespace {

/// How long a named pipe may take until its writer writes; files and other pipes are ready at once.
constexpr int kPatience_ms = 1000;

// End of the last whole line in text[from..size), 0 when there is none. A '\r' at the very end may be half of "\r\n".
std::size_t last_line_end(const char* text, std::size_t from, std::size_t size) {
  for (std::size_t i = size; i > from; --i) {
    if (text[i - 1] == '\n') return i;
    if (text[i - 1] == '\r' && i < size) return i;
  }
  return 0;
}

// The same where quoted cells may hold line ends.
std::size_t last_row_end(std::string_view text, char delimiter) {
  for (std::size_t from = 0;;) {
    bool open = false;
    const std::size_t end = row_end(text, from, delimiter, &open);
    if (open || end + 1 > text.size() || (text[end] == '\r' && end + 1 == text.size())) return from;
    from = end + (text[end] == '\r' && text[end + 1] == '\n' ? 2 : 1);
  }
}

}  // namespace

ChunkReader::ChunkReader(std::string path, std::size_t block_bytes, bool hash)
    : path_(std::move(path)), block_(std::max<std::size_t>(1, block_bytes)) {
  if (hash) digest_.known = detail::known_digest(path_);
  if (hash && digest_.known.empty()) digest_.sha.emplace();
  if (path_ == "-") {
    descriptor_ = ::dup(STDIN_FILENO);
    if (descriptor_ < 0)
      throw input_error("E0101", "standard input").says("cannot read: " + std::string(std::strerror(errno)));
    return;
  }
  // Without O_NONBLOCK a named pipe without a writer would hang the program here.
  descriptor_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor_ < 0) throw input_error("E0101", path_).says("cannot open: " + std::string(std::strerror(errno)));
  // A writer that waits for us in its own open() needs a moment to begin.
  pollfd waiting{descriptor_, POLLIN, 0};
  ::poll(&waiting, 1, kPatience_ms);
  ::fcntl(descriptor_, F_SETFL, ::fcntl(descriptor_, F_GETFL) & ~O_NONBLOCK);
  struct stat status {};
  const int looked = ::fstat(descriptor_, &status);
  if (looked != 0 || S_ISDIR(status.st_mode)) {
    const std::string why =
        looked != 0 ? "cannot be looked at: " + std::string(std::strerror(errno)) : "is a folder, a file was expected";
    ::close(descriptor_);
    throw input_error("E0101", path_).says(why);
  }
  regular_ = S_ISREG(status.st_mode);
  if (regular_) size_ = static_cast<std::uint64_t>(status.st_size);
  if (size_ > 0)
    block_ = std::min(block_, std::max<std::size_t>(4096, detail::in_memory(size_)));  // small files, small buffers
}

ChunkReader::ChunkReader(std::unique_ptr<Unpacker> text, std::string name, std::size_t block_bytes)
    : path_(std::move(name)),
      block_(std::max<std::size_t>(1, block_bytes)),
      file_ended_(true),
      unpacker_(std::move(text)) {}

ChunkReader::~ChunkReader() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::size_t ChunkReader::read_some(char* to, std::size_t n) {
  std::size_t done = packed() ? 0 : std::min(n, front_.size());
  if (done > 0) {
    std::memcpy(to, front_.data(), done);
    front_.erase(0, done);
  }
  while (packed() && done < n && !ended_) {
    const std::size_t got = unpacker_->read(to + done, n - done);
    ended_ = got == 0;
    done += got;
    refuse_bomb(read_ + done);
  }
  if (!packed()) {
    if (done < n) done += read_file(to + done, n - done);
    ended_ = file_ended_ && front_.empty();
  }
  read_ += done;
  return done;
}

void ChunkReader::refuse_bomb(std::uint64_t text) const {
  const std::uint64_t most = unpacker_->made() ? kMostMade : kMostPacked;
  const std::uint64_t stored = std::max(stored_.load(), unpacker_->stored_bytes());
  if (stored == 0 || !is_bomb(text, stored, most)) return;
  throw input_error("E0329", path_ == "-" ? "standard input" : path_)
      .says("its text is more than {} times as long as what is stored", most)
      .hint("unpack it, or save it as CSV");
}

// The bytes of a compressed file, which are those that are hashed.
std::size_t ChunkReader::read_stored(char* to, std::size_t n) {
  std::size_t done = std::min(n, front_.size());
  std::memcpy(to, front_.data(), done);
  front_.erase(0, done);
  if (done == 0) done = read_file(to, n);
  if (digest_.sha) digest_.sha->update({to, done});
  stored_ += done;
  return done;
}

void ChunkReader::look_for_packing() {
  if (packed()) return;
  front_.resize(kPackingBytes);
  front_.resize(read_file(front_.data(), kPackingBytes));
  const Packing packing = packing_of(front_);
  if (packing == Packing::none) return;
  unpacker_ = make_unpacker(
      packing, [this](char* to, std::size_t n) { return read_stored(to, n); }, path_ == "-" ? "standard input" : path_);
}

std::size_t ChunkReader::read_file(char* to, std::size_t n) {
  std::size_t done = 0;
  while (done < n && !file_ended_) {
    const ssize_t got = ::read(descriptor_, to + done, n - done);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0)
      throw input_error("E0101", path_ == "-" ? "standard input" : path_)
          .says("cannot read: " + std::string(std::strerror(errno)));
    if (got == 0) file_ended_ = true;
    done += static_cast<std::size_t>(got);
  }
  return done;
}

std::string_view ChunkReader::head() {
  const std::size_t first = std::size_t{1} << 16U;  // small files end here; long headers ask for more
  look_for_packing();
  head_.resize(first);
  std::size_t size = read_some(head_.data(), first);
  if (!ended_) {
    head_.resize(kHeadBytes);
    size += read_some(head_.data() + first, kHeadBytes - first);
  }
  head_.resize(size);
  if (!ended_) {  // exactly that long?
    char one = 0;
    if (read_some(&one, 1) == 1) head_.push_back(one);
  }
  if (digest_.sha && !packed()) digest_.sha->update(head_);
  return head_;
}

std::size_t ChunkReader::fill(char* to, std::size_t n, std::size_t& from_head) {
  from_head = std::min(n, head_.size() - taken_);
  std::memcpy(to, head_.data() + taken_, from_head);
  taken_ += from_head;
  if (taken_ == head_.size() && !head_.empty()) {
    head_ = {};
    taken_ = 0;
  }
  return from_head < n ? from_head + read_some(to + from_head, n - from_head) : from_head;
}

bool ChunkReader::next(RawChunk& chunk) {
  chunk.hash_from = chunk.hash_to = chunk.nuls_after = 0;
  if (done_) return false;
  const std::size_t carried = carry_.size();
  std::size_t size = carried, cut = 0, from_head = 0;
  chunk.bytes.resize(std::max(chunk.bytes.size(), size + block_ + kPadding));
  std::copy(carry_.begin(), carry_.end(), chunk.bytes.begin());
  chunk.offset = offset_;
  carry_.clear();
  while (cut == 0 && !done_) {
    const std::size_t searched = size == 0 ? 0 : size - 1;  // a '\r' that stood last may now have its '\n'
    const std::size_t more = std::max(block_, size / 2);    // a long row is not looked at for ever
    chunk.bytes.resize(std::max(chunk.bytes.size(), size + more + kPadding));
    std::size_t known = 0;
    size += fill(chunk.bytes.data() + size, more, known);
    from_head += known;
    done_ = (ended_ && taken_ >= head_.size()) || size > kMaxLine + block_;
    cut = done_                    ? size
          : dialect_->lines.quotes ? last_row_end({chunk.bytes.data(), size}, dialect_->delimiter)
                                   : last_line_end(chunk.bytes.data(), searched, size);
  }
  chunk.hash_from = carried + from_head;
  chunk.hash_to = size;
  std::fill_n(chunk.bytes.begin() + static_cast<std::ptrdiff_t>(size), kPadding, '\0');
  carry_.assign(chunk.bytes.begin() + static_cast<std::ptrdiff_t>(cut),
                chunk.bytes.begin() + static_cast<std::ptrdiff_t>(size));
  chunk.size = cut;
  if (done_) drop_nul_tail(chunk);
  if (done_ && packed_cut()) drop_cut_line(chunk);
  chunk.last = done_;
  offset_ += chunk.size;
  return chunk.size > 0 || !done_;
}

// A log cut by a power failure ends in NUL bytes: they are counted, and with them the line they cut off.
void ChunkReader::drop_nul_tail(RawChunk& chunk) {
  std::size_t kept = chunk.size;
  while (kept > 0 && chunk.bytes[kept - 1] == '\0') --kept;
  if (kept == chunk.size) return;
  std::vector<char> buffer(std::size_t{1} << 18U);
  std::uint64_t more = 0;
  while (!ended_ || taken_ < head_.size()) {
    std::size_t from_head = 0;
    const std::size_t n = fill(buffer.data(), buffer.size(), from_head);
    // Something stands behind the NULs: the row parser reports the first of them.
    if (std::any_of(buffer.data(), buffer.data() + n, [](char c) { return c != '\0'; })) return;
    chunk.nuls_after += n - from_head;
    more += n;
  }
  std::size_t line = kept;
  while (line > 0 && chunk.bytes[line - 1] != '\n' && chunk.bytes[line - 1] != '\r') --line;
  nuls_ = chunk.size - kept + more;
  cut_bytes_ = kept - line;
  chunk.size = line;
}

// Where compressed data end in the middle, so does the last line.
void ChunkReader::drop_cut_line(RawChunk& chunk) {
  const std::size_t whole = last_line_end(chunk.bytes.data(), 0, chunk.size);
  cut_bytes_ += chunk.size - whole;
  chunk.size = whole;
}

void ChunkReader::hash(const RawChunk& chunk) {
  if (!digest_.sha || packed()) return;
  digest_.sha->update({chunk.bytes.data() + chunk.hash_from, chunk.hash_to - chunk.hash_from});
  static constexpr char kZeros[4096] = {};
  for (std::uint64_t left = chunk.nuls_after; left > 0;) {
    const std::size_t n = std::min(detail::in_memory(left), sizeof kZeros);
    digest_.sha->update({kZeros, n});
    left -= n;
  }
}

std::string ChunkReader::finish_hash() {
  if (!digest_.sha) return digest_.known;
  if (!(packed() ? file_ended_ : ended_) && !regular_) return "";
  std::vector<char> buffer(std::size_t{1} << 18U);
  while (packed() && read_stored(buffer.data(), buffer.size()) > 0) {
  }
  while (!packed() && !ended_) digest_.sha->update({buffer.data(), read_some(buffer.data(), buffer.size())});
  return digest_.sha->finish();
}

}  // namespace libchar::csv
