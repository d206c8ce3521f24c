#pragma once
// Tables that are made of something else (JSON lines, sheets of workbooks, printed messages): text with one header line
// and commas between the cells, which then goes the way of every CSV file.

#include <cstddef>
#include <string>
#include <string_view>

#include "libchar/log/csv/unpacker.hpp"

namespace libchar::csv {

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
