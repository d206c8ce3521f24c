#include "libchar/core/fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/core/detail/match.hpp"

namespace libchar {
namespace {

std::vector<std::string> texts_of(std::span<const Word> words) {
  std::vector<std::string> out;
  for (const Word& word : words) out.emplace_back(word.word);
  return out;
}

int number_of(std::span<const Word> words, std::string_view text) {
  return std::find_if(words.begin(), words.end(), [&](const Word& w) { return w.word == text; })
      ->value;
}

// ---- reading ----

void read_row(const Field& row, const MapReader& at, void* object) {
  const std::string_view key = row.key;
  const FieldText& text = row.text;
  std::visit(Match{[&](void* part) {
                     fields_detail::read(row.below, at.map(key, keys_of(row.below)), part);
                   },
                   [&](bool* value) {
                     *value = text.words.empty()
                                  ? at.flag_or(key, false)
                                  : number_of(text.words, at.word(key, texts_of(text.words))) != 0;
                   },
                   [&](double* value) { *value = at.number(key, text.range); },
                   [&](std::uint64_t* value) { *value = at.count(key, text.range); },
                   [&](std::string* value) {
                     *value =
                         text.words.empty() ? at.text(key) : at.word(key, texts_of(text.words));
                   },
                   [&](std::optional<double>* value) { *value = at.number(key, text.range); },
                   [&](std::optional<std::uint64_t>* value) { *value = at.count(key, text.range); },
                   [&](std::optional<std::int64_t>* value) { *value = at.whole(key); },
                   [&](std::vector<double>* value) { *value = at.numbers(key); },
                   [&](std::vector<std::string>* value) { *value = at.texts(key); },
                   [&](const WordSlot& slot) {
                     slot.set(slot.at, number_of(text.words, at.word(key, texts_of(text.words))));
                   }},
             row.slot(object));
}

// ---- writing ----

Value value_of(const Field& row, void* object) {
  const auto optional = [](const auto* value) -> Value {
    if (*value) return **value;
    return {};
  };
  return std::visit(Match{[](void*) -> Value { return {}; },
                          [&](bool* value) -> Value {
                            if (row.text.words.empty()) return *value;
                            return std::string(word_of(row.text.words, *value ? 1 : 0));
                          },
                          [&](std::optional<double>* value) { return optional(value); },
                          [&](std::optional<std::uint64_t>* value) { return optional(value); },
                          [&](std::optional<std::int64_t>* value) { return optional(value); },
                          [&](const WordSlot& slot) -> Value {
                            return std::string(word_of(row.text.words, slot.get(slot.at)));
                          },
                          [](auto* value) -> Value { return *value; }},
                    row.slot(object));
}

bool same(const Field& row, void* object, void* defaults) {
  const Slot one = row.slot(object), other = row.slot(defaults);
  if (!std::holds_alternative<void*>(one)) return value_of(row, object) == value_of(row, defaults);
  return std::all_of(row.below.begin(), row.below.end(), [&](const Field& below) {
    return below.slot == nullptr || same(below, std::get<void*>(one), std::get<void*>(other));
  });
}

std::string substituted(std::string_view comment, const Substitutions& substitutions) {
  std::string out(comment);
  for (const auto& [name, text] : substitutions) {
    const std::string mark = fmt::format("{{{}}}", name);
    for (std::size_t at = 0; (at = out.find(mark, at)) != std::string::npos; at += text.size())
      out.replace(at, mark.size(), text);
  }
  return out;
}

std::string_view comment_of(const Field& row, const Value& value) {
  if (const auto* text = std::get_if<std::string>(&value))
    for (const Word& word : row.text.words)
      if (word.word == *text && !word.comment.empty()) return word.comment;
  return row.text.comment;
}

Entry constant_entry(const Field& row) {
  Entry entry{std::string(row.key), *row.constant};
  entry.comment = row.text.comment;
  entry.bare = true;
  return entry;
}

Entry entry_of(const Field& row, void* object, void* defaults, const Substitutions& substitutions) {
  Entry entry{std::string(row.key), value_of(row, object)};
  entry.comment = comment_of(row, entry.value);
  entry.bare = !row.text.words.empty() && !row.text.quoted;
  entry.form = row.text.form;
  const Slot slot = row.slot(object);
  if (void* const* part = std::get_if<void*>(&slot)) {
    const bool flow = entry.form == Entry::Form::flow;
    entry.form = flow ? Entry::Form::flow : Entry::Form::block;
    entry.below = fields_detail::entries(
        row.below, *part, std::get<void*>(row.slot(defaults)), substitutions, flow);
  }
  return entry;
}

// ---- docs ----

std::string kind_in_docs(const Field& row) {
  if (!row.text.words.empty()) return fmt::format("{}", fmt::join(texts_of(row.text.words), ", "));
  return std::string(row.text.unit.empty() ? row.kind : row.text.unit);
}

void add_rows(std::string& out, std::span<const Field> rows, const std::string& front) {
  for (const Field& row : rows) {
    if (row.key.empty()) continue;
    std::string meaning(row.text.meaning.empty() ? row.text.comment : row.text.meaning);
    if (!row.text.otherwise.empty()) meaning += "; " + std::string(row.text.otherwise);
    out += fmt::format("| {}`{}` | {} | {} |\n", front, row.key, kind_in_docs(row), meaning);
    add_rows(out, row.below, front + "– ");
  }
}

}  // namespace

std::string_view word_of(std::span<const Word> words, int value) {
  for (const Word& word : words)
    if (word.value == value) return word.word;
  return "";
}

std::vector<std::string> keys_of(std::span<const Field> rows) {
  std::vector<std::string> keys;
  for (const Field& row : rows)
    if (!row.key.empty()) keys.emplace_back(row.key);
  return keys;
}

namespace fields_detail {

std::string_view kind_of(const Slot& slot) {
  constexpr std::string_view kKinds[] = {"",
                                         "true, false",
                                         "number",
                                         "whole number",
                                         "text",
                                         "number",
                                         "whole number",
                                         "whole number",
                                         "list of numbers",
                                         "list of texts",
                                         ""};
  return kKinds[slot.index()];
}

void read(std::span<const Field> rows, const MapReader& at, void* object) {
  for (const Field& row : rows) {
    if (row.key.empty()) continue;
    if (row.text.required) at.require(row.key);
    if (row.read != nullptr)
      row.read(at, row.key, object);
    else if (row.constant && !row.text.words.empty() && at.has(row.key))
      at.word(row.key, texts_of(row.text.words));
    else if (row.constant)
      continue;
    else if (at.has(row.key))
      read_row(row, at, object);
  }
}

std::vector<Entry> entries(std::span<const Field> rows,
                           const void* object,
                           const void* defaults,
                           const Substitutions& substitutions,
                           bool all) {
  void* const from = const_cast<void*>(object);
  void* const usual = const_cast<void*>(defaults);
  std::vector<Entry> out;
  bool gap = false;
  for (const Field& row : rows) {
    const std::size_t before = out.size();
    if (row.text.written == Written::never) continue;
    if (row.write != nullptr)
      row.write(row, object, out);
    else if (row.constant)
      out.push_back(constant_entry(row));
    else if (row.slot == nullptr)
      gap = true;
    else if (all || row.text.written == Written::always || !same(row, from, usual))
      out.push_back(entry_of(row, from, usual, substitutions));
    if (before == out.size()) continue;
    out[before].gap = std::exchange(gap, false);
    for (std::size_t i = before; i < out.size(); ++i)
      out[i].comment = substituted(out[i].comment, substitutions);
  }
  return out;
}

}  // namespace fields_detail

void read_tool(const MapReader& at, std::string_view key) {
  if (at.has(key)) at.map(key, {"name", "version"});
}

std::string markdown_table(std::span<const Field> rows) {
  std::string out = "| key | value | meaning |\n|---|---|---|\n";
  add_rows(out, rows, "");
  return out;
}

}  // namespace libchar
