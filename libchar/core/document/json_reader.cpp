// JSON as a tree with places: nlohmann's parser with the guards it lacks.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr std::string_view kMark = "\xEF\xBB\xBF";  // byte order mark

struct Place {
  int line = 1, column = 1;
};

// Line and column of bytes that are asked for in rising order; a byte order mark takes no column.
class Places {
 public:
  explicit Places(std::string_view text) : text_(text), next_(text.starts_with(kMark) ? kMark.size() : 0) {}
  Place at(std::size_t byte) {
    for (; next_ < std::min(byte, text_.size()); ++next_) {
      ++place_.column;
      if (text_[next_] == '\n') place_ = {place_.line + 1, 1};
    }
    return place_;
  }

 private:
  std::string_view text_;
  std::size_t next_;
  Place place_;
};

// Bytes are those of the file.
std::string described(std::string_view text, std::size_t byte, const std::string& file) {
  const Place place = Places(text).at(byte);
  return fmt::format("{}:{}:{} (byte {})", file, place.line, place.column, byte);
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
  Guard(std::string_view text, const std::string& file) : text_(text), file_(file), read_(text.data()), places_(text) {}
  const char** furthest() { return &read_; }
  Document take() { return std::move(root_); }

  bool null() override {
    put(Document::Kind::null, "null", start_of("null"));
    return true;
  }
  bool boolean(bool value) override {
    const char* const word = value ? "true" : "false";
    put(Document::Kind::boolean, word, start_of(word)).boolean = value;
    return true;
  }
  // The parser's own reading of an integer is its text again, without a sign before 0.
  bool number_integer(number_integer_t value) override {
    return whole(std::to_string(value), static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return whole(std::to_string(value), static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t& literal) override {
    const std::size_t start = start_of_number(literal);
    if (!std::isfinite(value)) throw refusal("E0602", start).says("a number is out of range").got(literal);
    if (literal.find_first_of(".eE") == string_t::npos)
      throw refusal("E0602", start).says("an integer has more than 64 bits").got(literal);
    put(Document::Kind::number, literal, start).number = value;
    return true;
  }
  bool string(string_t& value) override {
    put(Document::Kind::text, value, start_of_text());
    return true;
  }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Document::Kind::map); }
  bool start_array(std::size_t) override { return open(Document::Kind::list); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    const std::size_t start = start_of_text();
    if (!keys_.back().insert(name).second)
      throw refusal("E0603", start).says("a key is repeated in one object").got(name);
    const Place place = places_.at(start);
    stack_.back()->map.push_back({name, place.line, place.column, {}});
    return true;
  }
  bool parse_error(std::size_t position, const std::string& token, const nlohmann::detail::exception& e) override {
    if (e.id == 406) throw refusal("E0602", start_of_number(token)).says("a number is out of range").got(token);
    std::string reason = e.what();
    const std::size_t colon = reason.find("syntax error");
    reason = colon == std::string::npos ? "is not valid JSON" : "is not valid JSON: " + reason.substr(colon);
    const std::size_t semicolon = reason.find("; last read");
    if (semicolon != std::string::npos) reason.resize(semicolon);
    throw input_error("E0601", described(text_, position == 0 ? 0 : position - 1, file_)).says(reason).got(token);
  }

 private:
  Refusal refusal(const char* code, std::size_t byte) { return input_error(code, described(text_, byte, file_)); }
  std::size_t byte() const { return static_cast<std::size_t>(read_ - text_.data()); }
  // Words, brackets and texts have been read to their last character.
  std::size_t start_of(std::string_view word) const { return byte() - word.size(); }
  // A number has been read to its end, or one character further when something follows.
  std::size_t start_of_number(std::string_view literal) const {
    const std::size_t end = byte();
    if (end > literal.size() && text_.substr(end - 1 - literal.size(), literal.size()) == literal)
      return end - 1 - literal.size();
    return end - std::min(end, literal.size());
  }
  std::size_t start_of_text() const {
    std::size_t quote = byte() - 1;
    const auto escaped = [&](std::size_t i) {
      std::size_t backslashes = 0;
      while (i > backslashes && text_[i - 1 - backslashes] == '\\') ++backslashes;
      return backslashes % 2 == 1;
    };
    do --quote;
    while (quote > 0 && (text_[quote] != '"' || escaped(quote)));
    return quote;
  }

  // Where the next value goes.
  Document& slot() {
    if (stack_.empty()) return root_;
    Document& parent = *stack_.back();
    return parent.kind == Document::Kind::list ? parent.list.emplace_back() : parent.map.back().value;
  }
  Document& put(Document::Kind kind, std::string text, std::size_t start) {
    if (++values_ > detail::kMaxDocumentValues)
      throw input_error("E0605", file_).says("JSON of more than {} values", detail::kMaxDocumentValues);
    Document& node = slot();
    const Place place = places_.at(start);
    node.kind = kind;
    node.text = std::move(text);
    node.line = place.line;
    node.column = place.column;
    return node;
  }
  bool whole(std::string literal, double value) {
    const std::size_t start = start_of_number(literal);
    Document& node = put(Document::Kind::number, std::move(literal), start);
    node.number = value;
    node.whole = true;
    return true;
  }
  bool open(Document::Kind kind) {
    if (stack_.size() >= kMaxDocumentDepth)
      throw input_error("E0604", file_).says("JSON is nested deeper than {} levels", kMaxDocumentDepth);
    stack_.push_back(&put(kind, "", byte() - 1));
    keys_.emplace_back();
    return true;
  }
  bool close() {
    stack_.pop_back();
    keys_.pop_back();
    return true;
  }

  std::string_view text_;
  const std::string& file_;
  const char* read_;
  std::size_t values_ = 0;
  Places places_;
  Document root_;
  std::vector<Document*> stack_;  // an open map or list is not moved: nothing is added beside it
  std::vector<std::set<std::string>> keys_;
};

}  // namespace

Document parse_json_document(std::string_view text, const std::string& file) {
  if (text.size() > kMaxDocumentBytes)
    throw input_error("E0605", file)
        .says("JSON file of {} bytes exceeds the limit of {}", text.size(), kMaxDocumentBytes);
  const std::string_view body = text.substr(text.starts_with(kMark) ? kMark.size() : 0);
  if (body.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw input_error("E0606", file + ":1:1 (byte 0)").says("is empty, a JSON document was expected");
  if (const std::size_t bad = first_invalid_utf8(text); bad != std::string_view::npos)
    throw input_error("E0607", described(text, bad, file))
        .says("is not valid UTF-8")
        .got(std::string(text.substr(bad, 1)));
  Guard guard(text, file);
  const char* end = text.data() + text.size();
  Json::sax_parse(Cursor{text.data(), guard.furthest()}, Cursor{end, guard.furthest()}, &guard);
  return guard.take();
}

Json parse_json(std::string_view text, const std::string& file) { return as_json(parse_json_document(text, file)); }

}  // namespace libchar
