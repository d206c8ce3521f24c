#include "libchar/core/json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <stdexcept>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;
constexpr std::size_t kMaxDepth = 64;

constexpr std::string_view kMark = "\xEF\xBB\xBF";  // byte order mark

// Bytes are those of the file; a byte order mark takes no column.
std::string place(std::string_view text, std::size_t byte, const std::string& file) {
  std::size_t line = 1, column = 1;
  for (std::size_t i = text.starts_with(kMark) ? kMark.size() : 0; i < std::min(byte, text.size());
       ++i) {
    ++column;
    if (text[i] == '\n') {
      ++line;
      column = 1;
    }
  }
  return fmt::format("{}:{}:{} (byte {})", file, line, column, byte);
}

// Where the parser is: nlohmann's events do not say.
struct Cursor {
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;
  const char* at;
  const char** furthest;
  const char& operator*() const { return *at; }
  Cursor& operator++() {
    *furthest = ++at;
    return *this;
  }
  Cursor operator++(int) {
    Cursor before = *this;
    ++*this;
    return before;
  }
  bool operator==(const Cursor& other) const { return at == other.at; }
  bool operator!=(const Cursor& other) const { return at != other.at; }
};

// Walks the events of the parser: builds the document, and refuses what nlohmann lets through.
class Guard : public nlohmann::json_sax<Json> {
 public:
  Guard(std::string_view text, std::string file)
      : text_(text), file_(std::move(file)), read_(text.data()) {}
  const char** furthest() { return &read_; }
  Json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t& literal) override {
    if (!std::isfinite(value))
      refuse("E0602", "a number is out of range", literal, start_of_number(literal));
    if (literal.find_first_of(".eE") == string_t::npos)
      refuse("E0602", "an integer has more than 64 bits", literal, start_of_number(literal));
    return put(value);
  }
  bool string(string_t& value) override { return put(value); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (!keys_.back().insert(name).second)
      refuse("E0603", "a key stands twice in one object", name, start_of_key());
    names_.back() = name;
    return true;
  }
  bool parse_error(std::size_t position,
                   const std::string& token,
                   const nlohmann::detail::exception& e) override {
    if (e.id == 406) refuse("E0602", "a number is out of range", token, start_of_number(token));
    std::string reason = e.what();
    const std::size_t colon = reason.find("syntax error");
    reason = colon == std::string::npos ? "is not valid JSON"
                                        : "is not valid JSON: " + reason.substr(colon);
    const std::size_t semicolon = reason.find("; last read");
    if (semicolon != std::string::npos) reason.resize(semicolon);
    throw Error({ErrorKind::input,
                 "E0601",
                 place(text_, position == 0 ? 0 : position - 1, file_),
                 reason,
                 token,
                 ""});
  }

 private:
  [[noreturn]] void refuse(const char* code,
                           const std::string& what,
                           const std::string& got,
                           std::size_t byte) {
    throw Error({ErrorKind::input, code, place(text_, byte, file_), what, got, ""});
  }
  // A number has been read to its end, or one character further when something follows.
  std::size_t start_of_number(const std::string& literal) const {
    const auto end = static_cast<std::size_t>(read_ - text_.data());
    if (end > literal.size() && text_.substr(end - 1 - literal.size(), literal.size()) == literal)
      return end - 1 - literal.size();
    return end - std::min(end, literal.size());
  }
  // A key has been read to its closing quote.
  std::size_t start_of_key() const {
    auto quote = static_cast<std::size_t>(read_ - text_.data()) - 1;
    const auto escaped = [&](std::size_t i) {
      std::size_t backslashes = 0;
      while (i > backslashes && text_[i - 1 - backslashes] == '\\') ++backslashes;
      return backslashes % 2 == 1;
    };
    do --quote;
    while (quote > 0 && (text_[quote] != '"' || escaped(quote)));
    return quote;
  }
  bool put(Json value) {
    if (stack_.empty()) {
      root_ = std::move(value);
    } else if (stack_.back()->is_array()) {
      stack_.back()->push_back(std::move(value));
    } else {
      (*stack_.back())[names_.back()] = std::move(value);
    }
    return true;
  }
  bool open(Json empty) {
    if (stack_.size() >= kMaxDepth)
      throw Error({ErrorKind::input,
                   "E0604",
                   file_,
                   fmt::format("JSON is nested deeper than {} levels", kMaxDepth),
                   "",
                   ""});
    Json* slot = nullptr;
    if (stack_.empty()) {
      root_ = std::move(empty);
      slot = &root_;
    } else if (stack_.back()->is_array()) {
      stack_.back()->push_back(std::move(empty));
      slot = &stack_.back()->back();
    } else {
      slot = &((*stack_.back())[names_.back()] = std::move(empty));
    }
    stack_.push_back(slot);
    keys_.emplace_back();
    names_.emplace_back();
    return true;
  }
  bool close() {
    stack_.pop_back();
    keys_.pop_back();
    names_.pop_back();
    return true;
  }

  std::string_view text_;
  std::string file_;
  const char* read_;
  Json root_;
  std::vector<Json*> stack_;
  std::vector<std::set<std::string>> keys_;
  std::vector<std::string> names_;
};

void check_finite(const Json& node) {
  if (node.is_number_float() && !std::isfinite(node.get<double>()))
    throw std::logic_error("a non-finite number reached a JSON document");
  if (node.is_structured())
    for (const Json& child : node) check_finite(child);
}

// nlohmann would throw, or write U+FFFD: what was there is kept readable instead.
void escape_strings(Json& node) {
  const auto bad = [](const std::string& text) {
    return first_invalid_utf8(text) != std::string_view::npos;
  };
  if (node.is_string() && bad(node.get_ref<const std::string&>()))
    node = printable(node.get_ref<const std::string&>());
  if (node.is_array())
    for (Json& child : node) escape_strings(child);
  if (!node.is_object()) return;
  Json copy = Json::object();
  for (auto& [key, child] : node.items()) {
    escape_strings(child);
    copy[bad(key) ? printable(key) : key] = std::move(child);
  }
  node = std::move(copy);
}

bool all_utf8(const Json& node) {
  if (node.is_string())
    return first_invalid_utf8(node.get_ref<const std::string&>()) == std::string_view::npos;
  if (node.is_array())
    for (const Json& child : node)
      if (!all_utf8(child)) return false;
  if (node.is_object())
    for (const auto& [key, child] : node.items())
      if (first_invalid_utf8(key) != std::string_view::npos || !all_utf8(child)) return false;
  return true;
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  if (text.size() > kMaxBytes)
    throw Error(
        {ErrorKind::input,
         "E0605",
         file,
         fmt::format("JSON file of {} bytes exceeds the limit of {}", text.size(), kMaxBytes),
         "",
         ""});
  const std::string_view body = text.substr(text.starts_with(kMark) ? kMark.size() : 0);
  if (body.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw Error({ErrorKind::input,
                 "E0606",
                 file + ":1:1 (byte 0)",
                 "is empty, a JSON document was expected",
                 "",
                 ""});
  if (const std::size_t bad = first_invalid_utf8(text); bad != std::string_view::npos)
    throw Error({ErrorKind::input,
                 "E0607",
                 place(text, bad, file),
                 "is not valid UTF-8",
                 std::string(text.substr(bad, 1)),
                 ""});
  Guard guard(text, file);
  const char* end = text.data() + text.size();
  Json::sax_parse(Cursor{text.data(), guard.furthest()}, Cursor{end, guard.furthest()}, &guard);
  return guard.take();
}

Json json_number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json json_number(const std::optional<double>& value) {
  return value ? json_number(*value) : Json(nullptr);
}

Json with_valid_text(Json document) {
  if (!all_utf8(document)) escape_strings(document);
  return document;
}

std::string dump_json(const Json& document) {
  check_finite(document);
  return with_valid_text(document).dump(2) + "\n";
}

}  // namespace libchar
