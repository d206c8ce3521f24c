// JSON lines (and an array of objects) as a table: RFC 8259 objects, a row each; what is nested is a
// column called by its path (imu.gyro[0]). Numbers keep their digits.
#include "libchar/log/csv/json_rows.hpp"

#include <algorithm>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/head/other_content.hpp"
#include "libchar/log/csv/object_rows.hpp"

namespace libchar::csv {
namespace {

constexpr std::size_t kDeepest = 32;

/// Walks one object, whose brackets are known to close.
class ObjectCells {
 public:
  ObjectCells(std::string_view text, std::string at) : text_(text), where_(std::move(at)) {}

  std::vector<ObjectCell> cells() && {
    value("", 0);
    blanks();
    if (at_ != text_.size()) refuse();
    return std::move(cells_);
  }

 private:
  [[noreturn]] void refuse() const {
    throw input_error("E0337", where_)
        .says("is not the object that JSON lines hold")
        .got(std::string(text_.substr(std::min(at_, text_.size()), 40)))
        .hint("one object for each row: {\"t\": 0.01, \"gyro\": [0.1, 0.2, 0.3]}");
  }
  void blanks() {
    while (at_ < text_.size() && std::string_view(" \t\r\n").find(text_[at_]) != std::string_view::npos) ++at_;
  }
  char here() {
    blanks();
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool next_is(char c) {
    if (here() != c) return false;
    ++at_;
    return true;
  }

  void value(const std::string& path, std::size_t depth) {
    if (depth > kDeepest) refuse();
    const char first = here();
    if (first == '{') return object(path, depth);
    if (first == '[') return array(path, depth);
    if (path.empty()) refuse();
    if (first == '"') {
      cells_.push_back({path, string(), true});
      return;
    }
    const std::size_t end = std::min(text_.find_first_of(",}] \t\r\n", at_), text_.size());
    if (end == at_) refuse();
    const std::string_view word = text_.substr(at_, end - at_);
    if (word.find_first_of("\":{[") != std::string_view::npos) refuse();
    at_ = end;
    cells_.push_back({path, word == "null" ? "" : std::string(word), false});
  }

  void object(const std::string& path, std::size_t depth) {
    ++at_;
    if (next_is('}')) return;
    do {
      if (here() != '"') refuse();
      const std::string key = string();
      if (!next_is(':')) refuse();
      value(path.empty() ? key : path + "." + key, depth + 1);
    } while (next_is(','));
    if (!next_is('}')) refuse();
  }

  void array(const std::string& path, std::size_t depth) {
    ++at_;
    if (next_is(']')) return;
    std::size_t index = 0;
    do value(path + "[" + std::to_string(index++) + "]", depth + 1);
    while (next_is(','));
    if (!next_is(']')) refuse();
  }

  std::string string() {
    std::string out;
    for (++at_; at_ < text_.size() && text_[at_] != '"'; ++at_) {
      if (text_[at_] != '\\') {
        out += text_[at_];
        continue;
      }
      ++at_;
      static constexpr std::string_view kLetters = "bfnrt", kMeant = "\b\f\n\r\t";
      const char letter = at_ < text_.size() ? text_[at_] : '\0';
      if (letter == 'u')
        append_utf8(out, character());
      else if (const std::size_t k = kLetters.find(letter); k != std::string_view::npos)
        out += kMeant[k];
      else
        out += letter;
    }
    if (at_ >= text_.size()) refuse();
    ++at_;
    return out;
  }

  /// Of "\u00e9"; halves of pairs, which stand in no name of a channel, as '?'.
  std::uint32_t character() {
    std::uint32_t code = 0;
    for (int k = 0; k < 4; ++k) {
      const char digit = ++at_ < text_.size() ? static_cast<char>(text_[at_] | 0x20) : '\0';
      if (digit >= '0' && digit <= '9')
        code = 16 * code + static_cast<std::uint32_t>(digit - '0');
      else if (digit >= 'a' && digit <= 'f')
        code = 16 * code + static_cast<std::uint32_t>(digit - 'a' + 10);
      else
        refuse();
    }
    return code >= 0xD800 && code < 0xE000 ? '?' : code;
  }

  std::string_view text_;
  std::string where_;
  std::size_t at_ = 0;
  std::vector<ObjectCell> cells_;
};

class JsonRows final : public ObjectRows {
 public:
  using ObjectRows::ObjectRows;
  std::string_view what() const override { return "objects of JSON, a row each"; }
  std::string_view format() const override { return "jsonl"; }
  std::string_view row_name() const override { return "object"; }

 protected:
  std::optional<MadeObject> next() override {
    MadeObject object;
    if (!next_object(object)) return std::nullopt;
    if (!object.broken) object.cells = ObjectCells(object.text, place()).cells();
    return object;
  }
  void alone(const MadeObject& document) const override { refuse_other_content(document.text, file_); }

 private:
  /// From its first bracket to the one that closes it; what stands between objects is '[', ',' and ']'.
  bool next_object(MadeObject& object) {
    static constexpr std::string_view kBetween = " \t\r\n,[]";
    for (;;) {
      from_.at = std::min(from_.raw.find_first_not_of(kBetween, from_.at), from_.raw.size());
      if (from_.at < from_.raw.size()) break;
      if (!from_.more()) return false;
    }
    ++objects_;
    std::size_t depth = 0, length = 0;
    bool quoted = false, escaped = false;
    for (;; ++length) {
      if (from_.at + length == from_.raw.size()) {
        if (length > kMaxLine) refuse_long();
        if (!from_.more()) {
          end_is_cut();
          return false;
        }
      }
      const char c = from_.raw[from_.at + length];
      const bool line = length == 0 && c != '{';
      // An object at the begin of a line, inside of another: that one is broken.
      const bool next = c == '{' && length > 0 && from_.raw[from_.at + length - 1] == '\n';
      if (line || next) return broken(length, object);
      if (escaped) {
        escaped = false;
      } else if (quoted) {
        escaped = c == '\\';
        quoted = c != '"';
      } else if (c == '"') {
        quoted = true;
      } else if (c == '{' || c == '[') {
        ++depth;
      } else if ((c == '}' || c == ']') && --depth == 0) {
        object.text = from_.raw.substr(from_.at, length + 1);
        from_.at += length + 1;
        return true;
      }
    }
  }
  /// What is no object, to the end of its line.
  bool broken(std::size_t length, MadeObject& object) {
    std::size_t end = from_.raw.find('\n', from_.at + length);
    while (length == 0 && end == std::string::npos && from_.raw.size() - from_.at < kMaxLine && from_.more())
      end = from_.raw.find('\n', from_.at);
    if (length == 0) length = std::min(end, from_.raw.size()) - from_.at;
    object.text = from_.raw.substr(from_.at, length);
    from_.at += length;
    return object.broken = true;
  }
  [[noreturn]] void refuse_long() const {
    throw input_error("E0337", place()).says("an object of more than {} bytes", kMaxLine);
  }
};

}  // namespace

bool is_json_rows(std::string_view front) {
  const auto next = [&] {
    const std::size_t at = std::min(front.find_first_not_of(" \t\r\n"), front.size());
    front.remove_prefix(at);
    const char c = front.empty() ? '\0' : front[0];
    front.remove_prefix(std::min<std::size_t>(1, front.size()));
    return c;
  };
  char c = next();
  if (c == '[') c = next();
  return c == '{' && next() == '"';
}

std::unique_ptr<Unpacker> open_json_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                         const std::string& file) {
  return std::make_unique<JsonRows>(std::move(stored), file);
}

}  // namespace libchar::csv
