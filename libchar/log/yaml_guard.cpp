#include "libchar/log/yaml_guard.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <charconv>
#include <sstream>

#include "libchar/core/error.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;
constexpr std::size_t kMaxDepth = 64;

// Builds the document from the parser's events, so that an alias is seen as an alias and never
// followed.
class Guard : public YAML::EventHandler {
 public:
  explicit Guard(const std::string& file) : file_(file) {}
  Json take() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    check(mark, "", anchor);
    put(mark, nullptr, "");
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    refuse(mark, "aliases are not read", "*");
  }
  void OnScalar(const YAML::Mark& mark,
                const std::string& tag,
                YAML::anchor_t anchor,
                const std::string& value) override {
    check(mark, tag == "!" ? "" : tag, anchor);  // "!" marks a quoted text, "?" a plain one
    put(mark, tag == "!" ? Json(value) : plain(mark, value), value);
  }
  void OnSequenceStart(const YAML::Mark& mark,
                       const std::string& tag,
                       YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    check(mark, tag, anchor);
    open(mark, Json::array());
  }
  void OnSequenceEnd() override { stack_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark,
                  const std::string& tag,
                  YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    check(mark, tag, anchor);
    open(mark, Json::object());
  }
  void OnMapEnd() override { stack_.pop_back(); }

 private:
  struct Level {
    Json* node = nullptr;
    bool awaits_value = false;
    std::string key;
  };

  [[noreturn]] void refuse(const YAML::Mark& mark, std::string what, std::string got) const {
    throw Error({ErrorKind::input,
                 "E0521",
                 fmt::format("{}:{}:{}", file_, mark.line + 1, mark.column + 1),
                 std::move(what),
                 std::move(got),
                 ""});
  }
  void check(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) const {
    if (!tag.empty() && tag != "?") refuse(mark, "tags are not read", tag);
    if (anchor != 0) refuse(mark, "anchors are not read", "&");
  }

  // Numbers as JSON has them; everything else stays a text.
  Json plain(const YAML::Mark& mark, const std::string& value) const {
    if (value == "true" || value == "false") return value == "true";
    if (value == "null" || value == "~") return nullptr;
    if (value == "<<") refuse(mark, "merge keys are not read", value);
    const std::string_view magnitude =
        std::string_view(value).substr(value.starts_with('-') ? 1 : 0);
    if (magnitude.empty() || magnitude[0] < '0' || magnitude[0] > '9') return value;
    if (magnitude.size() > 1 && magnitude[0] == '0' && magnitude[1] >= '0' && magnitude[1] <= '9')
      return value;
    const char* const end = value.data() + value.size();
    std::uint64_t natural = 0;
    if (const auto r = std::from_chars(value.data(), end, natural);
        r.ec == std::errc() && r.ptr == end)
      return natural;
    std::int64_t integer = 0;
    if (const auto r = std::from_chars(value.data(), end, integer);
        r.ec == std::errc() && r.ptr == end)
      return integer;
    if (const auto number = parse_double(value)) return *number;
    return value;
  }

  void put(const YAML::Mark& mark, Json value, const std::string& as_key) {
    if (stack_.empty()) {
      root_ = std::move(value);
      return;
    }
    Level& level = stack_.back();
    if (level.node->is_array()) {
      level.node->push_back(std::move(value));
    } else if (!level.awaits_value) {
      if (level.node->contains(as_key)) refuse(mark, "a key stands twice", as_key);
      level.key = as_key;
      level.awaits_value = true;
    } else {
      (*level.node)[level.key] = std::move(value);
      level.awaits_value = false;
    }
  }

  void open(const YAML::Mark& mark, Json empty) {
    if (stack_.size() >= kMaxDepth)
      refuse(mark, fmt::format("is nested deeper than {} levels", kMaxDepth), "");
    if (stack_.empty()) {
      root_ = std::move(empty);
      stack_.push_back({&root_, false, ""});
      return;
    }
    Level& level = stack_.back();
    Json* slot = nullptr;
    if (level.node->is_array()) {
      level.node->push_back(std::move(empty));
      slot = &level.node->back();
    } else {
      if (!level.awaits_value) refuse(mark, "a list or map cannot be a key", "");
      slot = &((*level.node)[level.key] = std::move(empty));
      level.awaits_value = false;
    }
    stack_.push_back({slot, false, ""});
  }

  const std::string& file_;
  Json root_;
  std::vector<Level> stack_;
};

}  // namespace

Json parse_guarded_yaml(std::string_view text, const std::string& file) {
  const auto refuse = [&](std::string where, std::string what) {
    throw Error({ErrorKind::input, "E0522", std::move(where), std::move(what), "", ""});
  };
  if (text.size() > kMaxBytes)
    refuse(file, fmt::format("YAML of {} bytes exceeds the limit of {}", text.size(), kMaxBytes));
  if (first_invalid_utf8(text) != std::string_view::npos)
    refuse(fmt::format("{} (byte {})", file, first_invalid_utf8(text)), "is not valid UTF-8");
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    refuse(file + ":1:1", "is empty");
  try {
    std::istringstream in{std::string(text)};
    YAML::Parser parser(in);
    Guard guard(file);
    if (!parser.HandleNextDocument(guard)) refuse(file + ":1:1", "holds no document");
    Guard second(file);
    if (parser.HandleNextDocument(second)) refuse(file, "holds a second document");
    return guard.take();
  } catch (const YAML::Exception& error) {
    refuse(fmt::format("{}:{}:{}", file, error.mark.line + 1, error.mark.column + 1),
           "is not valid YAML: " + error.msg);
  }
  return {};
}

}  // namespace libchar
