#include "libchar/core/document/document.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <istream>
#include <nlohmann/json.hpp>
#include <set>
#include <streambuf>

#include "libchar/core/file/file_text.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxKey = 1024;
constexpr std::size_t kMaxKeys = 10000;  // a map is searched key by key

bool is_digit(char c) { return c >= '0' && c <= '9'; }

Document scalar(Document::Kind kind, const std::string& text) {
  Document node;
  node.kind = kind;
  node.text = text;
  return node;
}

// What an unquoted scalar means: numbers as JSON has them; everything else stays a text.
Document unquoted(const std::string& value) {
  if (value == "true" || value == "false") {
    Document node = scalar(Document::Kind::boolean, value);
    node.boolean = value == "true";
    return node;
  }
  if (value == "null" || value == "~") return scalar(Document::Kind::null, value);
  const std::string_view magnitude = std::string_view(value).substr(value.starts_with('-') ? 1 : 0);
  const bool octal = magnitude.size() > 1 && magnitude[0] == '0' && is_digit(magnitude[1]);
  if (magnitude.empty() || !is_digit(magnitude[0]) || octal) return scalar(Document::Kind::text, value);
  const auto number = parse_double(value);
  if (!number) return scalar(Document::Kind::text, value);
  Document node = scalar(Document::Kind::number, value);
  node.number = *number;
  node.whole = magnitude.find_first_not_of("0123456789") == std::string_view::npos;
  return node;
}

// Builds the tree from the parser's events, so that an alias is seen as an alias and never followed.
class Builder : public YAML::EventHandler {
 public:
  explicit Builder(const std::string& file) : file_(file) {}
  Document take() { return std::move(root_); }
  const YAML::Mark& place() const { return place_; }  // of the last value

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    check(mark, "", anchor);
    put(mark, Document{});
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override {
    throw refusal(mark).says("aliases are not read").got("*");
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    const bool quoted = tag == "!";  // "!" marks a quoted text, "?" an unquoted one
    check(mark, quoted ? "" : tag, anchor);
    if (!quoted && value == "<<") throw refusal(mark).says("merge keys are not read").got(value);
    put(mark, quoted ? scalar(Document::Kind::text, value) : unquoted(value));
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    check(mark, tag, anchor);
    open(mark, Document::Kind::list);
  }
  void OnSequenceEnd() override { stack_.pop_back(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    check(mark, tag, anchor);
    open(mark, Document::Kind::map);
  }
  void OnMapEnd() override { stack_.pop_back(); }

 private:
  struct Level {
    Document* node = nullptr;
    bool awaits_value = false;
    std::set<std::string> keys = {};
  };

  Refusal refusal(const YAML::Mark& mark) const {
    return input_error("E0521", fmt::format("{}:{}:{}", file_, mark.line + 1, mark.column + 1));
  }
  void check(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor) const {
    if (!tag.empty() && tag != "?") throw refusal(mark).says("tags are not read").got(tag);
    if (anchor != 0) throw refusal(mark).says("anchors are not read").got("&");
  }

  void add_key(const YAML::Mark& mark, Level& level, const std::string& key) {
    if (key.size() > kMaxKey) throw refusal(mark).says("a key is longer than {} characters", kMaxKey).got(key);
    if (level.node->map.size() >= kMaxKeys) throw refusal(mark).says("a map has more than {} keys", kMaxKeys).got(key);
    if (!level.keys.insert(key).second) throw refusal(mark).says("a key is repeated").got(key);
    level.node->map.push_back({key, mark.line + 1, mark.column + 1, {}});
    level.awaits_value = true;
  }

  // Where the next value goes; nothing when it is a key.
  Document* slot() {
    if (stack_.empty()) return &root_;
    Level& level = stack_.back();
    if (level.node->kind == Document::Kind::list) return &level.node->list.emplace_back();
    if (!level.awaits_value) return nullptr;
    level.awaits_value = false;
    return &level.node->map.back().value;
  }

  Document* put(const YAML::Mark& mark, Document value) {
    place_ = mark;
    if (++values_ > detail::kMaxDocumentValues)
      throw input_error("E0522", file_).says("YAML of more than {} values", detail::kMaxDocumentValues);
    value.line = mark.line + 1;
    value.column = mark.column + 1;
    Document* place = slot();
    if (place == nullptr) {
      add_key(mark, stack_.back(), value.text);
      return nullptr;
    }
    *place = std::move(value);
    return place;
  }

  void open(const YAML::Mark& mark, Document::Kind kind) {
    if (stack_.size() >= kMaxDocumentDepth)
      throw refusal(mark).says("is nested deeper than {} levels", kMaxDocumentDepth);
    if (!stack_.empty() && stack_.back().node->kind == Document::Kind::map && !stack_.back().awaits_value)
      throw refusal(mark).says("a list or map cannot be a key");
    stack_.push_back({put(mark, scalar(kind, ""))});
  }

  const std::string& file_;
  Document root_;
  std::vector<Level> stack_;
  std::size_t values_ = 0;
  YAML::Mark place_ = {};
};

// The document for the parser, which reads a list in brackets to its end before it says that one begins, in case it
// is a key, and takes 200 bytes for each bracket on its way.
class Feed : public std::streambuf {
 public:
  Feed(std::string_view text, const std::string& file, const Builder& builder) : file_(file), builder_(builder) {
    char* const begin = const_cast<char*>(text.data());  // only read
    setg(begin, begin, begin + text.size());
  }

 protected:
  std::streamsize xsgetn(char* to, std::streamsize most) override {
    constexpr std::ptrdiff_t kMostAhead = std::ptrdiff_t{1} << 19;
    const YAML::Mark& place = builder_.place();
    if (gptr() - eback() - place.pos > kMostAhead)
      throw input_error("E0522", fmt::format("{}:{}:{}", file_, place.line + 1, place.column + 1))
          .says("a value of more than {} bytes follows: a long text, or lists within lists in brackets", kMostAhead)
          .hint(place.pos == 0 ? "a recording is read by inspect and characterize"
                               : "a document in JSON is read as such from a file called .json");
    return std::streambuf::xsgetn(to, most);
  }

 private:
  const std::string& file_;
  const Builder& builder_;
};

void check_bytes(std::string_view text, const std::string& file) {
  if (text.size() > kMaxDocumentBytes)
    throw input_error("E0522", file).says("YAML of {} bytes exceeds the limit of {}", text.size(), kMaxDocumentBytes);
  if (first_invalid_utf8(text) != std::string_view::npos)
    throw input_error("E0522", fmt::format("{} (byte {})", file, first_invalid_utf8(text))).says("is not valid UTF-8");
  if (const std::size_t zero = text.find('\0'); zero != std::string_view::npos) {
    const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(zero), '\n');
    const std::size_t start = zero == 0 ? std::string_view::npos : text.rfind('\n', zero - 1);
    const std::size_t column = start == std::string_view::npos ? zero + 1 : zero - start;
    throw input_error("E0522", fmt::format("{}:{}:{}", file, line, column)).says("holds a zero byte");
  }
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos)
    throw input_error("E0522", file + ":1:1").says("is empty");
}

// The first line with a tab in its indentation, 0 when there is none.
int line_indented_by_tab(std::string_view text) {
  int line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view indent = text.substr(at, text.find_first_not_of(" \t", at) - at);
    if (at + indent.size() < end && indent.find('\t') != std::string_view::npos) return line;
    at = end + 1;
  }
  return 0;
}

Json number_json(const Document& node) {
  const char* const end = node.text.data() + node.text.size();
  if (node.whole) {
    std::uint64_t natural = 0;
    if (const auto r = std::from_chars(node.text.data(), end, natural); r.ec == std::errc() && r.ptr == end)
      return natural;
    std::int64_t integer = 0;
    if (const auto r = std::from_chars(node.text.data(), end, integer); r.ec == std::errc() && r.ptr == end)
      return integer;
  }
  return node.number;
}

}  // namespace

const DocumentEntry* Document::find(std::string_view key) const {
  for (const DocumentEntry& entry : map)
    if (entry.key == key) return &entry;
  return nullptr;
}

Document parse_yaml_document(std::string_view text, const std::string& file) {
  check_bytes(text, file);
  try {
    Builder builder(file);
    Feed feed(text, file, builder);
    std::istream in(&feed);
    YAML::Parser parser(in);
    if (!parser.HandleNextDocument(builder)) throw input_error("E0522", file + ":1:1").says("holds no document");
    Builder second(file);
    if (parser.HandleNextDocument(second)) throw input_error("E0522", file).says("holds a second document");
    return builder.take();
  } catch (const YAML::Exception& error) {
    if (const int line = line_indented_by_tab(text); line > 0 && line <= error.mark.line + 1)
      throw input_error("E0522", fmt::format("{}:{}:1", file, line))
          .says("is not valid YAML: a line is indented with a tab; YAML needs spaces");
    throw input_error("E0522", fmt::format("{}:{}:{}", file, error.mark.line + 1, error.mark.column + 1))
        .says("is not valid YAML: " + error.msg);
  }
}

Document parse_document(std::string_view text, const std::string& file) {
  return file.ends_with(".json") ? parse_json_document(text, file) : parse_yaml_document(text, file);
}

Json as_json(const Document& node) {
  switch (node.kind) {
    case Document::Kind::boolean:
      return node.boolean;
    case Document::Kind::number:
      return number_json(node);
    case Document::Kind::text:
      return node.text;
    case Document::Kind::list: {
      Json list = Json::array();
      for (const Document& value : node.list) list.push_back(as_json(value));
      return list;
    }
    case Document::Kind::map: {
      Json map = Json::object();
      for (const DocumentEntry& entry : node.map) detail::add_member(map, entry.key, as_json(entry.value));
      return map;
    }
    case Document::Kind::null:
      break;
  }
  return nullptr;
}

namespace {}  // namespace

std::string read_document_text(const std::string& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (descriptor < 0) {
    const int reason = errno;
    throw input_error("E0551", path).says(std::string("cannot be read: ") + std::strerror(reason));
  }
  struct Closer {
    int descriptor;
    ~Closer() { ::close(descriptor); }
  } closer{descriptor};
  struct stat status {};
  if (::fstat(descriptor, &status) != 0)
    throw input_error("E0551", path).says(std::string("cannot be read: ") + std::strerror(errno));
  if (S_ISDIR(status.st_mode)) throw input_error("E0551", path).says("is a folder, a file was expected");
  if (!S_ISREG(status.st_mode)) throw input_error("E0551", path).says("is not a regular file");
  if (static_cast<std::size_t>(status.st_size) > kMaxDocumentBytes)
    throw input_error("E0551", path)
        .says("{} bytes exceed the limit of {}", status.st_size, kMaxDocumentBytes)
        .hint("is this a log? a model or scene file is a short text");
  return rest_of_file(descriptor, path, kMaxDocumentBytes);
}

}  // namespace libchar
