#include "libchar/core/json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;
constexpr std::size_t kMaxDepth = 64;

std::string place(std::string_view text, std::size_t byte, const std::string& file) {
  std::size_t line = 1, column = 1;
  for (std::size_t i = 0; i < std::min(byte, text.size()); ++i) {
    ++column;
    if (text[i] == '\n') {
      ++line;
      column = 1;
    }
  }
  return fmt::format("{}:{}:{} (byte {})", file, line, column, byte);
}

// Walks the events of the parser: builds the document, and refuses what nlohmann lets through.
class Guard : public nlohmann::json_sax<Json> {
 public:
  Guard(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}
  Json take() { return std::move(root_); }

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t& literal) override {
    if (!std::isfinite(value)) refuse("E0602", "a number is out of range", literal);
    return put(value);
  }
  bool string(string_t& value) override { return put(value); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool key(string_t& name) override {
    if (!keys_.back().insert(name).second) refuse("E0603", "a key stands twice in one object", name);
    names_.back() = name;
    return true;
  }
  bool parse_error(std::size_t position, const std::string& token, const nlohmann::detail::exception& e) override {
    std::string reason = e.what();
    const std::size_t colon = reason.find("syntax error");
    reason = colon == std::string::npos ? "is not valid JSON" : "is not valid JSON: " + reason.substr(colon);
    const std::size_t semicolon = reason.find("; last read");
    if (semicolon != std::string::npos) reason.resize(semicolon);
    throw Error({ErrorKind::input, "E0601", place(text_, position == 0 ? 0 : position - 1, file_), reason, token, ""});
  }

 private:
  [[noreturn]] void refuse(const char* code, const std::string& what, const std::string& got) {
    const std::size_t at = text_.find(got);
    throw Error({ErrorKind::input, code, at == std::string_view::npos ? file_ : place(text_, text_.rfind(got), file_), what, got, ""});
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
      throw Error({ErrorKind::input, "E0604", file_, fmt::format("JSON is nested deeper than {} levels", kMaxDepth), "", ""});
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
  Json root_;
  std::vector<Json*> stack_;
  std::vector<std::set<std::string>> keys_;
  std::vector<std::string> names_;
};

void check_finite(const Json& node) {
  if (node.is_number_float() && !std::isfinite(node.get<double>())) throw std::logic_error("a non-finite number reached a JSON document");
  if (node.is_structured())
    for (const Json& child : node) check_finite(child);
}

}  // namespace

Json parse_json(std::string_view text, const std::string& file) {
  if (text.size() > kMaxBytes)
    throw Error({ErrorKind::input, "E0605", file, fmt::format("JSON file of {} bytes exceeds the limit of {}", text.size(), kMaxBytes), "", ""});
  if (text.substr(0, 3) == "\xEF\xBB\xBF") text.remove_prefix(3);
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw Error({ErrorKind::input, "E0606", file + ":1:1 (byte 0)", "is empty, a JSON document was expected", "", ""});
  if (const std::size_t bad = first_invalid_utf8(text); bad != std::string_view::npos)
    throw Error({ErrorKind::input, "E0607", place(text, bad, file), "is not valid UTF-8", std::string(text.substr(bad, 1)), ""});
  Guard guard(text, file);
  Json::sax_parse(text.begin(), text.end(), &guard);
  return guard.take();
}

std::string dump_json(const Json& document) {
  check_finite(document);
  return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace libchar
