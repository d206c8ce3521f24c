// Messages as `rostopic echo` and `ros2 topic echo` print them: documents of YAML with nothing but keys, items, numbers
// and words, which "---" ends.
#include <algorithm>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/object_rows.hpp"

namespace libchar::csv {
namespace {

constexpr std::size_t kDeepestEcho = 32;
constexpr std::string_view kWord = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_", kEnd = "---";
constexpr std::string_view kWarning = "WARNING: ";  // of the command, in front of its first message

/// The lines of one message.
class MessageLines {
 public:
  std::vector<ObjectCell> cells;

  /// False for a line that no message has.
  bool add(std::string_view line) {
    std::size_t indent = std::min(line.find_first_not_of(' '), line.size());
    line = trimmed(line);
    if (line.empty()) return true;
    while (line == "-" || line.starts_with("- ")) {
      close([&](const Open& open) { return open.indent > indent; });
      if (open_.empty() || open_.size() > kDeepestEcho) return false;
      const std::string path = item(open_.back());
      line = trimmed(line.substr(1));
      if (!line.empty() && key_length(line) == 0) return scalar(path, line);
      open_.push_back({++indent, path});
      if (line.empty()) return true;
      ++indent;
    }
    const std::size_t key = key_length(line);
    if (key == 0) return false;
    close([&](const Open& open) { return open.indent >= indent; });
    if (open_.size() > kDeepestEcho) return false;
    const std::string name(trimmed(line.substr(0, key)));
    const std::string path = open_.empty() ? name : open_.back().path + "." + name;
    const std::string_view value = trimmed(line.substr(key + 1));
    if (!value.empty()) return value.front() == '[' ? list(path, value) : scalar(path, value);
    open_.push_back({indent, path});
    return true;
  }

 private:
  /// A key, or an item of a list, whose values are in the lines below.
  struct Open {
    std::size_t indent = 0;
    std::string path;
    std::size_t items = 0;
  };

  template <class Ends>
  void close(Ends ends) {
    while (!open_.empty() && ends(open_.back())) open_.pop_back();
  }
  static std::string item(Open& open) { return open.path + "[" + std::to_string(open.items++) + "]"; }
  /// Up to the colon behind a key; 0 where there is none.
  static std::size_t key_length(std::string_view line) {
    const std::size_t end = line.find_first_not_of(kWord);
    const bool key = end < line.size() && line[end] == ':' && (end + 1 == line.size() || line[end + 1] == ' ');
    return key ? end : 0;
  }

  bool scalar(const std::string& path, std::string_view value) {
    const bool quoted = value.size() > 1 && (value[0] == '"' || value[0] == '\'') && value.back() == value[0];
    if (quoted) value = value.substr(1, value.size() - 2);
    cells.push_back({path, std::string(value), quoted || value.find(',') != std::string_view::npos});
    return true;
  }
  bool list(const std::string& path, std::string_view values) {
    if (values.back() != ']') return false;
    values = trimmed(values.substr(1, values.size() - 2));
    Open open{0, path};
    while (!values.empty()) {
      const std::size_t end = std::min(values.find(','), values.size());
      scalar(item(open), trimmed(values.substr(0, end)));
      values.remove_prefix(std::min(end + 1, values.size()));
    }
    return true;
  }

  std::vector<Open> open_;
};

class EchoRows final : public ObjectRows {
 public:
  using ObjectRows::ObjectRows;
  std::string_view what() const override { return "messages that ROS printed, a row each"; }
  std::string_view row_name() const override { return "message"; }

 protected:
  std::optional<MadeObject> next() override {
    MadeObject object;
    MessageLines lines;
    ++objects_;
    for (std::string line; from_.line(line, kMaxLine);) {
      if (object.text.empty() && (line == kEnd || (objects_ == 1 && line.starts_with(kWarning)))) continue;
      if (line == kEnd) {
        object.cells = std::move(lines.cells);
        if (object.broken) object.cells.clear();
        return object;
      }
      object.text += line + "\n";
      if (object.text.size() > kMaxLine) throw input_error("E0337", place()).says("more than {} bytes", kMaxLine);
      if (!lines.add(line) && !object.broken) {
        object.broken = true;
        object.text = line + "\n";
      }
    }
    if (!object.text.empty()) end_is_cut();
    return std::nullopt;
  }
};

}  // namespace

bool is_echo(std::string_view front) {
  const auto take_line = [&] {
    const std::string_view line = front.substr(0, front.find('\n'));
    front.remove_prefix(std::min(line.size() + 1, front.size()));
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
  };
  std::string_view first = take_line();
  while (first.starts_with(kWarning)) first = take_line();
  const std::size_t colon = first.find_first_not_of(kWord);
  if (colon == 0 || colon == std::string_view::npos || first[colon] != ':') return false;
  const std::string_view key = first.substr(0, colon + 1), value = trimmed(first.substr(colon + 1));
  if (!value.empty() && first[colon + 1] != ' ') return false;
  if (key == "header:" && value.empty() && front.starts_with("  ")) return true;
  while (!front.empty() && take_line() != kEnd) {
  }
  return front.starts_with(key);
}

std::unique_ptr<Unpacker> open_echo_rows(std::function<std::size_t(char*, std::size_t)> stored,
                                         const std::string& file) {
  return std::make_unique<EchoRows>(std::move(stored), file);
}

}  // namespace libchar::csv
