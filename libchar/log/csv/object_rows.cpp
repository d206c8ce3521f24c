#include "libchar/log/csv/object_rows.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/refusal.hpp"
#include "libchar/log/csv/head/dialect.hpp"

namespace libchar::csv {

void ObjectRows::finish(Findings& findings) const {
  if (late_ > 0) findings.add("late_key", "keys that the first objects do not have: left out", first_late_, late_);
}

std::string ObjectRows::place() const { return fmt::format("{} ({} {})", file_, row_name(), objects_); }

bool ObjectRows::more(std::string& text) {
  if (columns_.empty()) {
    learn(text);
    if (columns_.empty()) return false;
  }
  if (!head_.empty()) {
    row(head_.front(), text);
    head_.pop_front();
    return true;
  }
  const auto object = next();
  if (object) row(*object, text);
  return object.has_value();
}

/// The columns are the keys of the first objects.
void ObjectRows::learn(std::string& text) {
  constexpr std::size_t kHead = std::size_t{1} << 18U;
  std::size_t bytes = 0;
  while (bytes < kHead) {
    auto object = next();
    if (!object) break;
    bytes += object->text.size();
    for (const ObjectCell& cell : object->cells) {
      if (!columns_.emplace(cell.path, columns_.size()).second) continue;
      if (columns_.size() > kMaxColumns) throw input_error("E0337", place()).says("more than {} keys", kMaxColumns);
      if (columns_.size() > 1) text += ',';
      add_quoted(text, cell.path);
    }
    head_.push_back(std::move(*object));
  }
  if (columns_.size() * head_.size() / kMostMade > std::max(bytes, kHead))
    throw input_error("E0337", place()).says("{} keys in {} objects: most are in few", columns_.size(), head_.size());
  text += '\n';
  if (head_.size() == 1 && from_.ended) alone(head_.front());
}

void ObjectRows::row(const MadeObject& object, std::string& text) {
  std::vector<std::string> cells(object.broken ? 1 : columns_.size());
  constexpr std::size_t kShown = 40;
  if (object.broken) add_quoted(cells[0], "broken object: " + object.text.substr(0, kShown));  // as any broken line
  for (const ObjectCell& cell : object.cells) {
    const auto column = columns_.find(cell.path);
    if (column == columns_.end()) {
      if (late_++ == 0) first_late_ = cell.path;
      continue;
    }
    std::string& to = cells[column->second];
    to.clear();
    if (cell.quoted)
      add_quoted(to, cell.text);
    else
      to = cell.text;
  }
  for (std::size_t c = 0; c < cells.size(); ++c) text += (c > 0 ? "," : "") + cells[c];
  text += '\n';
}

}  // namespace libchar::csv
