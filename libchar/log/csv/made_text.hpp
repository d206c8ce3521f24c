#pragma once
// Tables that are made of something else (JSON lines, sheets of workbooks, printed messages): text with one header line
// and commas between the cells, which then goes the way of every CSV file.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "libchar/log/csv/unpacker.hpp"

namespace libchar::csv {

/// Bytes that come piece by piece, of which those from `at` on are not used up.
struct Feed {
  std::function<std::size_t(char*, std::size_t)> stored;
  std::string raw = {};
  std::size_t at = 0;
  bool ended = false;
  char line_end = '\n';
  /// Forgets what is used up and reads on; false at the end.
  bool more() {
    constexpr std::size_t kPiece = std::size_t{1} << 16U;
    if (ended) return false;
    raw.erase(0, at);
    at = 0;
    const std::size_t before = raw.size();
    raw.resize(before + kPiece);
    const std::size_t got = stored(raw.data() + before, kPiece);
    raw.resize(before + got);
    ended = got == 0;
    return !ended;
  }
  /// The next line without its end, at most about `most` bytes of it; false at the end.
  bool line(std::string& text, std::size_t most) {
    std::size_t end = raw.find(line_end, at);
    while (end == std::string::npos && raw.size() - at <= most && more()) end = raw.find(line_end, at);
    if (at == raw.size()) return false;
    text = raw.substr(at, std::min(end, raw.size()) - at);
    at = std::min(end, raw.size() - 1) + 1;
    while (text.ends_with('\r')) text.pop_back();
    return true;
  }
};

/// Text of which each line is written anew, without its carriage return.
class CleanedLines : public DecodedText {
 public:
  explicit CleanedLines(std::function<std::size_t(char*, std::size_t)> stored) : feed_{std::move(stored)} {}

 protected:
  virtual void begin(std::string_view front) = 0;  ///< the first kPackingBytes
  virtual void clean(std::string& line) = 0;

 private:
  void decode() final {
    if (!known_ && feed_.more()) {
      const std::string_view front = std::string_view(feed_.raw).substr(0, kPackingBytes);
      feed_.line_end = front.find('\n') == std::string_view::npos ? '\r' : '\n';
      begin(front);
    }
    known_ = true;
    std::string line;
    constexpr std::size_t kMost = std::size_t{1} << 20U, kPiece = std::size_t{1} << 16U;
    while (text_.size() < kPiece && !done_) {
      done_ = !feed_.line(line, kMost);
      if (done_) break;
      clean(line);
      text_ += line;
      if (feed_.raw[feed_.at - 1] == feed_.line_end) text_ += feed_.line_end;
    }
  }

  Feed feed_;
  bool known_ = false;
};

class MadeText : public Unpacker {
 public:
  std::size_t read(char* to, std::size_t n) final {
    while (at_ == text_.size() && !done_) {
      text_.clear();
      at_ = 0;
      done_ = !more(text_);
    }
    const std::size_t taken = text_.copy(to, n, at_);
    at_ += taken;
    return taken;
  }
  bool cut() const final { return cut_; }
  bool made() const final { return true; }

 protected:
  /// Adds the next rows; false behind the last one.
  virtual bool more(std::string& text) = 0;
  void end_is_cut() { cut_ = true; }

  /// In quotes, whatever it holds.
  static void add_quoted(std::string& row, std::string_view cell) {
    row += '"';
    for (const char c : cell) {
      if (c == '"') row += '"';
      if (c != '\0') row += c;
    }
    row += '"';
  }

 private:
  std::string text_;
  std::size_t at_ = 0;
  bool done_ = false, cut_ = false;
};

}  // namespace libchar::csv
