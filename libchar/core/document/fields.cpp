#include "libchar/core/document/fields.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <iterator>

#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"

namespace libchar {
namespace {

using detail::Match;

std::vector<std::string> texts_of(std::span<const Word> words) {
  std::vector<std::string> out;
  for (const Word& word : words) out.emplace_back(word.word);
  return out;
}

int number_of(std::span<const Word> words, std::string_view text) {
  return std::find_if(words.begin(), words.end(), [&](const Word& w) { return w.word == text; })->value;
}

bool is_columns(const Field& row) { return row.layout == Layout::columns; }

// The keys of a part stand beside the others.
bool is_beside(const Field& row) { return row.key.empty() && row.slot != nullptr; }

// ---- reading ----

std::vector<Interval> read_intervals(const MapReader& at, std::string_view key) {
  std::vector<Interval> out;
  for (const Document& one : at.list(key))
    out.push_back(one.kind == Document::Kind::null ? Interval{kNone, kNone} : at.interval_in(key, one));
  return out;
}

[[noreturn]] void refuse_element(const MapReader& at, std::string_view key, const Document& value,
                                 const char* expected) {
  throw input_error("E0982", at.where(value)).says("{}: {} was expected", at.path_of(key), expected).got(value.text);
}

// One value of a column. What is null stays as it is where the row says what that means, and is NaN elsewhere.
void read_element(const Field& row, const MapReader& at, const Document& value, void* part) {
  const bool null = value.kind == Document::Kind::null;
  if (null && row.text.known != nullptr) return;
  const auto number = [&](const char* what, bool right) {
    if (!right) refuse_element(at, row.key, value, what);
    return value.number;
  };
  const bool is_number = value.kind == Document::Kind::number;
  std::visit(
      Match{[&](double* to) { *to = null ? kNone : number("a number", is_number); },
            [&](std::uint64_t* to) {
              *to = static_cast<std::uint64_t>(number("a whole number", is_number && value.whole && value.number >= 0));
            },
            [&](bool* to) {
              number("true or false", value.kind == Document::Kind::boolean);
              *to = value.boolean;
            },
            [&](Interval* to) {
              *to = null ? Interval{kNone, kNone} : at.interval_in(row.key, value);
            },
            [&](std::string* to) { *to = value.text; }, [](auto) {}},
      row.slot(part));
}

void read_columns(const Field& columns, const MapReader& at, const PartsSlot& parts) {
  bool first = true;
  for (const Field& row : columns.below) {
    if (row.slot == nullptr || !at.has(row.key)) continue;
    if (std::exchange(first, false)) parts.resize(parts.at, at.list(row.key).size());
    const std::size_t length = parts.size(parts.at);
    const std::vector<Document>& values = at.list(row.key, length);
    for (std::size_t i = 0; i < length; ++i) read_element(row, at, values[i], parts.part(parts.at, i));
  }
}

void read_parts(const Field& row, const MapReader& at, const PartsSlot& parts) {
  if (is_columns(row)) {
    if (is_beside(row)) return read_columns(row, at, parts);
    return read_columns(row, at.map(row.key, keys_of(row.below)), parts);
  }
  const std::vector<MapReader> maps =
      row.kind == "list" ? at.maps(row.key, keys_of(row.below)) : std::vector{at.map(row.key, keys_of(row.below))};
  parts.resize(parts.at, maps.size());
  for (std::size_t i = 0; i < maps.size(); ++i) fields_detail::read(row.below, maps[i], parts.part(parts.at, i));
}

void read_row(const Field& row, const MapReader& at, void* object) {
  const std::string_view key = row.key;
  const FieldText& text = row.text;
  const auto interval = [&] {
    const Interval ends = at.interval_in(key, at.require(key));
    if (std::isfinite(ends.low) && ends.low < text.range.lowest)
      at.refuse(key, fmt::format("expected numbers of at least {}", shortest(text.range.lowest)));
    return ends;
  };
  std::visit(
      Match{
          [&](void* part) {
            if (is_beside(row)) return fields_detail::read(row.below, at, part);
            fields_detail::read(row.below, at.map(key, keys_of(row.below)), part);
          },
          [&](bool* value) {
            *value = text.words.empty() ? at.flag_or(key, false)
                                        : number_of(text.words, at.word(key, texts_of(text.words))) != 0;
          },
          [&](double* value) { *value = at.number(key, text.range); },
          [&](std::uint64_t* value) { *value = at.count(key, text.range); },
          [&](std::string* value) { *value = text.words.empty() ? at.text(key) : at.word(key, texts_of(text.words)); },
          [&](std::optional<double>* value) { *value = at.number(key, text.range); },
          [&](std::optional<std::uint64_t>* value) { *value = at.count(key, text.range); },
          [&](std::optional<std::int64_t>* value) { *value = at.whole(key); },
          [&](std::vector<double>* value) { *value = at.numbers(key); },
          [&](std::vector<std::string>* value) { *value = at.texts(key); },
          [&](int* value) { *value = static_cast<int>(at.whole(key)); }, [&](Interval* value) { *value = interval(); },
          [&](std::optional<Interval>* value) { *value = interval(); },
          [&](std::vector<Interval>* value) { *value = read_intervals(at, key); },
          [&](std::vector<std::vector<double>>* value) {
            value->clear();
            for (const Document& one : at.list(key)) value->push_back(at.numbers_in(key, one));
          },
          [&](const PartsSlot& parts) { read_parts(row, at, parts); },
          [&](const WordSlot& slot) { slot.set(slot.at, number_of(text.words, at.word(key, texts_of(text.words)))); }},
      row.slot(object));
}

// What a null of a report says of a number.
void read_null(const Field& row, void* object) {
  if (row.slot == nullptr || row.text.known != nullptr) return;
  std::visit(Match{[](double* value) { *value = kNone; },
                   [](Interval* value) {
                     *value = {kNone, kNone};
                   },
                   [](auto) {}},
             row.slot(object));
}

// ---- writing ----

Value value_of(const Field& row, void* object) {
  const auto optional = [](const auto* value) -> Value {
    if (*value) return **value;
    return {};
  };
  return std::visit(
      Match{[](void*) -> Value { return {}; }, [](const PartsSlot&) -> Value { return {}; },
            [](std::vector<std::vector<double>>*) -> Value { return {}; },
            [](int* value) -> Value { return std::int64_t{*value}; },
            [&](std::optional<Interval>* value) { return optional(value); },
            [&](bool* value) -> Value {
              if (row.text.words.empty()) return *value;
              return std::string(word_of(row.text.words, *value ? 1 : 0));
            },
            [&](std::optional<double>* value) { return optional(value); },
            [&](std::optional<std::uint64_t>* value) { return optional(value); },
            [&](std::optional<std::int64_t>* value) { return optional(value); },
            [&](const WordSlot& slot) -> Value { return std::string(word_of(row.text.words, slot.get(slot.at))); },
            [](auto* value) -> Value { return *value; }},
      row.slot(object));
}

bool same(const Field& row, void* object, void* defaults) {
  const Slot one = row.slot(object), other = row.slot(defaults);
  if (const auto* parts = std::get_if<PartsSlot>(&one)) return parts->size(parts->at) == 0;
  if (auto* const* lists = std::get_if<std::vector<std::vector<double>>*>(&one)) return (*lists)->empty();
  if (!std::holds_alternative<void*>(one)) return value_of(row, object) == value_of(row, defaults);
  return std::all_of(row.below.begin(), row.below.end(), [&](const Field& below) {
    return below.slot == nullptr || same(below, std::get<void*>(one), std::get<void*>(other));
  });
}

std::string substituted(std::string_view comment, const Substitutions& substitutions) {
  std::string out(comment);
  if (out.find('{') == std::string::npos) return out;
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

Entry constant_entry(const Field& row, const Substitutions& substitutions) {
  Entry entry{std::string(row.key), *row.constant};
  if (auto* text = std::get_if<std::string>(&entry.value)) *text = substituted(*text, substitutions);
  entry.comment = row.text.comment;
  entry.bare = true;
  return entry;
}

bool is_known(const Field& row, const void* object) { return row.text.known == nullptr || row.text.known(object); }

template <class T>
Value gathered(const Field& row, const PartsSlot& parts, const T& none) {
  std::vector<T> out;
  const std::size_t n = parts.size(parts.at);
  out.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    void* const part = parts.part(parts.at, i);
    const Value value = is_known(row, part) ? value_of(row, part) : Value{};
    const T* const known = std::get_if<T>(&value);
    out.push_back(known != nullptr ? *known : none);
  }
  return out;
}

Value column_of(const Field& row, const PartsSlot& parts) {
  const Interval unknown{kNone, kNone};
  return std::visit(Match{[&](bool*) { return gathered<bool>(row, parts, false); },
                          [&](std::uint64_t*) { return gathered<std::uint64_t>(row, parts, 0); },
                          [&](std::string*) { return gathered<std::string>(row, parts, ""); },
                          [&](Interval*) { return gathered<Interval>(row, parts, unknown); },
                          [&](auto) { return gathered<double>(row, parts, kNone); }},
                    row.slot(const_cast<void*>(parts.usual)));
}

std::vector<Entry> columns_of(const Field& columns, const PartsSlot& parts) {
  std::vector<Entry> out;
  for (const Field& row : columns.below) {
    bool wanted = row.text.written == Written::always;
    for (std::size_t i = 0; i < parts.size(parts.at) && !wanted; ++i)
      wanted = !same(row, parts.part(parts.at, i), const_cast<void*>(parts.usual));
    if (wanted) out.push_back({std::string(row.key), column_of(row, parts)});
  }
  return out;
}

// Null where there is no part.
Entry parts_entry(const Field& row, const PartsSlot& parts, const Substitutions& substitutions) {
  const std::string key(row.key);
  if (is_columns(row)) return part_entry(key, columns_of(row, parts));
  const auto below = [&](std::size_t i) {
    return fields_detail::entries(row.below, parts.part(parts.at, i), parts.usual, substitutions);
  };
  const std::size_t n = parts.size(parts.at);
  if (row.kind != "list") return n == 0 ? Entry{key} : part_entry(key, below(0));
  const bool flow = row.text.form == Entry::Form::flow;
  Entry list = part_entry(key, {}, Entry::Form::list);
  list.comment = row.text.comment;
  for (std::size_t i = 0; i < n; ++i)
    list.below.push_back(part_entry("", below(i), flow ? Entry::Form::flow : Entry::Form::block));
  return list;
}

Entry entry_of(const Field& row, void* object, void* defaults, const Substitutions& substitutions) {
  Entry entry{std::string(row.key), value_of(row, object)};
  entry.comment = comment_of(row, entry.value);
  entry.bare = !row.text.words.empty() && !row.text.quoted;
  entry.form = row.text.form;
  const Slot slot = row.slot(object);
  if (const auto* parts = std::get_if<PartsSlot>(&slot)) return parts_entry(row, *parts, substitutions);
  if (auto* const* lists = std::get_if<std::vector<std::vector<double>>*>(&slot)) {
    entry.form = Entry::Form::list;
    for (const std::vector<double>& list : **lists) entry.below.push_back({"", list});
  }
  if (void* const* part = std::get_if<void*>(&slot)) {
    const bool flow = entry.form == Entry::Form::flow;
    entry.form = flow ? Entry::Form::flow : Entry::Form::block;
    entry.below = fields_detail::entries(row.below, *part, std::get<void*>(row.slot(defaults)), substitutions, flow);
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
    if (row.kind != "list") add_rows(out, row.below, front + "– ");
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
  for (const Field& row : rows) {
    if (!row.key.empty()) keys.emplace_back(row.key);
    if (is_beside(row)) std::ranges::move(keys_of(row.below), std::back_inserter(keys));
  }
  return keys;
}

namespace fields_detail {

std::string_view kind_of(const Slot& slot) {
  constexpr std::string_view kKinds[] = {
      "",       "true, false",     "number",       "whole number",    "text",
      "number", "whole number",    "whole number", "list of numbers", "list of texts",
      "",       "whole number",    "[low, high]",  "[low, high]",     "list of [low, high]",
      "",       "lists of numbers"};
  return kKinds[slot.index()];
}

std::string_view kind_of(const Value& value) {
  constexpr std::string_view kKinds[] = {"",
                                         "true, false",
                                         "number",
                                         "whole number",
                                         "whole number",
                                         "text",
                                         "list of numbers",
                                         "list of texts",
                                         "",
                                         "",
                                         "[low, high]",
                                         "list of [low, high]"};
  return kKinds[value.index()];
}

void read(std::span<const Field> rows, const MapReader& at, void* object) {
  for (const Field& row : rows) {
    if (is_beside(row)) read_row(row, at, object);
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
    else if (at.is_null(row.key))
      read_null(row, object);
  }
}

std::vector<Entry> entries(std::span<const Field> rows, const void* object, const void* defaults,
                           const Substitutions& substitutions, bool all) {
  void* const from = const_cast<void*>(object);
  void* const usual = const_cast<void*>(defaults);
  std::vector<Entry> out;
  bool gap = false;
  for (const Field& row : rows) {
    const std::size_t before = out.size();
    const Written written = row.text.written;
    if (written == Written::never) continue;
    if (!is_known(row, object)) {
      if (written != Written::if_known) out.push_back({std::string(row.key)});
    } else if (row.write != nullptr)
      row.write(row, object, out);
    else if (row.constant)
      out.push_back(constant_entry(row, substitutions));
    else if (row.slot == nullptr)
      gap = true;
    else if (is_beside(row))
      std::ranges::move(entry_of(row, from, usual, substitutions).below, std::back_inserter(out));
    else if (all || written == Written::if_known || written == Written::always || !same(row, from, usual))
      out.push_back(entry_of(row, from, usual, substitutions));
    if (before == out.size()) continue;
    out[before].gap = std::exchange(gap, false);
    for (std::size_t i = before; i < out.size(); ++i) out[i].comment = substituted(out[i].comment, substitutions);
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
