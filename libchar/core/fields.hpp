#pragma once
// One description per document: rows {key, member, unit, range, words, comment}, from which come its reader (with line,
// column and the nearest key), its YAML, its JSON, the settings that a report records and the table of keys in docs/.
//
//   const Fields<Sidecar> kRows = {
//       field<&Sidecar::rate_hz>("rate_hz", {.unit = "Hz", .range = kPositive, .comment = "sampling rate"}),
//       field<&Sidecar::planar>("order", {.words = kOrders}), …};
//   Sidecar sidecar;
//   read_fields(kRows, MapReader(document, file, "", keys_of(kRows)), sidecar);
//   write(json_of(entries_of(kRows, sidecar)));

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "libchar/core/entry.hpp"
#include "libchar/core/enum_table.hpp"
#include "libchar/core/schema.hpp"

namespace libchar {

/// A word of a file and the value it stands for: an enumerator as a number, or true and false.
struct Word {
  std::string_view word;
  int value = 0;
  std::string_view comment = "";  ///< behind the word in YAML
};

/// The word of `value`, "" when there is none.
std::string_view word_of(std::span<const Word> words, int value);

/// The words of an enum that has a table of them (core/enum_table.hpp), in its order.
template <EnumWithTable Enum>
std::span<const Word> words_in_fields() {
  static constexpr auto words = [] {
    std::array<Word, enum_table<Enum>.size()> out;
    std::transform(
        enum_table<Enum>.begin(), enum_table<Enum>.end(), out.begin(), [](const auto& row) {
          return Word{row.word, static_cast<int>(row.value)};
        });
    return out;
  }();
  return words;
}

/// A member that a file writes as one of a few words.
struct WordSlot {
  void* at;
  int (*get)(const void*);
  void (*set)(void*, int);
};

/// Where the value of a row is in memory: `void*` is a part with rows of its own.
using Slot = std::variant<void*,
                          bool*,
                          double*,
                          std::uint64_t*,
                          std::string*,
                          std::optional<double>*,
                          std::optional<std::uint64_t>*,
                          std::optional<std::int64_t>*,
                          std::vector<double>*,
                          std::vector<std::string>*,
                          WordSlot>;

enum class Written {
  always,
  when_set,  ///< when it differs from what an absent key means
  never,     ///< read only
};

struct FieldText {
  std::string_view unit = "";      ///< in docs
  NumberRange range = kAnyNumber;  ///< of a number
  std::span<const Word> words =
      {};  ///< all that a text or an enumeration may be; of an enum with a table: those
  std::string_view comment = "";    ///< in YAML; "{NAME}" stands for a substitution
  std::string_view meaning = "";    ///< in docs; the comment when empty
  std::string_view otherwise = "";  ///< in docs: what an absent key means
  Written written = Written::when_set;
  bool required = false;
  bool quoted = false;  ///< a word that YAML 1.1 would not take for a text: yes, no
  Entry::Form form = Entry::Form::value;  ///< in YAML, of a list or of a part with rows of its own
};

struct Field {
  std::string_view key;  ///< empty: an empty line of YAML
  Slot (*slot)(void* object) = nullptr;
  FieldText text = {};
  std::string_view kind = "";  ///< in docs: "number", "text"…
  std::vector<Field> below = {};
  std::optional<Value> constant = std::nullopt;  ///< in place of the slot: always written
  /// In place of the slot, for what is no single member.
  void (*read)(const MapReader& at, std::string_view key, void* object) = nullptr;
  void (*write)(const Field& field, const void* object, std::vector<Entry>& out) = nullptr;
};

/// A row of a document about a T.
template <class T>
struct Row {
  Field field;
};

template <class T>
struct Fields {
  std::vector<Field> rows;
  Fields(std::initializer_list<Row<T>> list) {
    for (const Row<T>& row : list) rows.push_back(row.field);
  }
};

/// "{NAME}" of comments, and what stands for it.
using Substitutions = std::vector<std::pair<std::string_view, std::string>>;

namespace fields_detail {

template <class M>
struct MemberOf;
template <class T, class M>
struct MemberOf<M T::*> {
  using Class = T;
  using Type = M;
};

template <class V>
Slot slot_of(V& value) {
  if constexpr (std::is_enum_v<V>) {
    return WordSlot{&value,
                    [](const void* at) { return static_cast<int>(*static_cast<const V*>(at)); },
                    [](void* at, int number) { *static_cast<V*>(at) = static_cast<V>(number); }};
  } else if constexpr (std::is_constructible_v<Slot, V*> && !std::is_class_v<V>) {
    return &value;
  } else if constexpr (requires(Slot slot) { std::get<V*>(slot); }) {
    return &value;
  } else {
    return static_cast<void*>(&value);
  }
}

// What is only written is asked for its slots too, and not changed.
template <auto First, auto... Rest>
Slot slot_at(void* object) {
  using T = typename MemberOf<decltype(First)>::Class;
  return slot_of(((static_cast<T*>(object)->*First).*....*Rest));
}

template <auto First, auto... Rest>
using MemberAt = std::remove_cvref_t<decltype((
    (std::declval<typename MemberOf<decltype(First)>::Class&>().*First).*....*Rest))>;

template <class Member>
FieldText with_enum_words(FieldText text) {
  if constexpr (EnumWithTable<Member>)
    if (text.words.empty()) text.words = words_in_fields<Member>();
  return text;
}

std::string_view kind_of(const Slot& slot);

void read(std::span<const Field> rows, const MapReader& at, void* object);
std::vector<Entry> entries(std::span<const Field> rows,
                           const void* object,
                           const void* defaults,
                           const Substitutions& substitutions,
                           bool all = false);

}  // namespace fields_detail

/// A member, or a member of a member: field<&Options::allan, &AllanOptions::tau_min_s>("tau_min_s").
template <auto First, auto... Rest>
auto field(std::string_view key, const FieldText& text = {}) {
  using T = typename fields_detail::MemberOf<decltype(First)>::Class;
  T object{};
  return Row<T>{{key,
                 &fields_detail::slot_at<First, Rest...>,
                 fields_detail::with_enum_words<fields_detail::MemberAt<First, Rest...>>(text),
                 fields_detail::kind_of(fields_detail::slot_at<First, Rest...>(&object))}};
}

/// A key with keys below it, about a member that has rows of its own.
template <auto Member, class Part>
auto part(std::string_view key, const Fields<Part>& rows, const FieldText& text = {}) {
  using T = typename fields_detail::MemberOf<decltype(Member)>::Class;
  return Row<T>{{key, &fields_detail::slot_at<Member>, text, "", rows.rows}};
}

/// The same about the object itself: the file has a level that the struct has not.
template <class T>
Row<T> level(std::string_view key, const Fields<T>& rows, const FieldText& text = {}) {
  return {{key, [](void* object) -> Slot { return object; }, text, "", rows.rows}};
}

/// What every file of a format says; of the words that it may be only checked when read.
template <class T>
Row<T> constant(std::string_view key, Value value, const FieldText& text = {}) {
  Field row{key, nullptr, text};
  row.constant = std::move(value);
  return {std::move(row)};
}

/// "tool": {name, version} of the program that wrote the file.
void read_tool(const MapReader& at, std::string_view key);
template <class T>
Row<T> tool_row() {
  Field row{"tool", nullptr, {.meaning = "the program that wrote the file"}, "`name`, `version`"};
  row.read = [](const MapReader& at, std::string_view key, void*) { read_tool(at, key); };
  row.write = [](const Field& field, const void*, std::vector<Entry>& out) {
    out.push_back(tool_entry(field.key));
  };
  return {std::move(row)};
}

/// An empty line in YAML, in front of whatever is written next.
template <class T>
Row<T> empty_line() {
  return {{""}};
}

/// What is no single member: Read is void(const MapReader&, std::string_view key, T&), Write is
/// void(const Field&, const T&, std::vector<Entry>&).
template <class T, auto Read, auto Write>
Row<T> custom(std::string_view key, std::string_view kind, const FieldText& text = {}) {
  Field row{key, nullptr, text, kind};
  row.read = [](const MapReader& at, std::string_view name, void* object) {
    Read(at, name, *static_cast<T*>(object));
  };
  row.write = [](const Field& f, const void* object, std::vector<Entry>& out) {
    Write(f, *static_cast<const T*>(object), out);
  };
  return {std::move(row)};
}

std::vector<std::string> keys_of(std::span<const Field> rows);
template <class T>
std::vector<std::string> keys_of(const Fields<T>& fields) {
  return keys_of(std::span<const Field>(fields.rows));
}

/// Reads the values that are there; a member whose key is absent stays as it is. Throws Error(input).
template <class T>
void read_fields(const Fields<T>& fields, const MapReader& at, T& object) {
  fields_detail::read(fields.rows, at, &object);
}

/// What a file about `object` says.
template <class T>
std::vector<Entry> entries_of(const Fields<T>& fields,
                              const T& object,
                              const Substitutions& substitutions = {}) {
  const T defaults{};
  return fields_detail::entries(fields.rows, &object, &defaults, substitutions);
}

/// The same rows, all of them written always.
template <class T>
Fields<T> always(Fields<T> fields) {
  for (Field& row : fields.rows) row.text.written = Written::always;
  return fields;
}

/// The rows of these keys in this order, each written always or when it is set.
template <class T>
Fields<T> selected(const Fields<T>& fields,
                   std::initializer_list<std::string_view> keys,
                   Written written) {
  Fields<T> out({});
  for (const std::string_view key : keys)
    for (const Field& row : fields.rows)
      if (row.key == key) out.rows.emplace_back(row).text.written = written;
  return out;
}

/// "| key | value | meaning |" in Markdown, the rows of a part below it with a dash in front.
std::string markdown_table(std::span<const Field> rows);
template <class T>
std::string markdown_table(const Fields<T>& fields) {
  return markdown_table(std::span<const Field>(fields.rows));
}

}  // namespace libchar
