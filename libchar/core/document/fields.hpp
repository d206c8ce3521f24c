#pragma once
// One description per document: rows {key, member, unit, range, words, comment}. Its reader (with line, column and the
// nearest key), its YAML and its JSON come from them. So do the settings that a report records and the table of keys in
// docs/.
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

#include "libchar/core/document/entry.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/document/schema.hpp"

namespace libchar {

/// A word of a file and the value it stands for: an enumerator as a number, or true and false.
struct Word {
  std::string_view word;
  int value = 0;
  std::string_view comment = "";  ///< after the word in YAML
};

/// The word of `value`, "" when there is none.
std::string_view word_of(std::span<const Word> words, int value);

/// The words of an enum that has a table of them (core/enum_table.hpp), in its order.
template <EnumWithTable Enum>
std::span<const Word> words_in_fields() {
  static constexpr auto words = [] {
    std::array<Word, enum_table<Enum>.size()> out;
    std::transform(enum_table<Enum>.begin(), enum_table<Enum>.end(), out.begin(), [](const auto& row) {
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

/// Parts with rows of their own: of a vector, or the one of an optional.
struct PartsSlot {
  void* at;
  std::size_t (*size)(const void*);
  void (*resize)(void*, std::size_t);
  void* (*part)(void*, std::size_t);
  const void* usual;  ///< what absent keys mean
};

/// Where the value of a row is in memory: `void*` is a part with rows of its own.
using Slot = std::variant<void*, bool*, double*, std::uint64_t*, std::string*, std::optional<double>*,
                          std::optional<std::uint64_t>*, std::optional<std::int64_t>*, std::vector<double>*,
                          std::vector<std::string>*, WordSlot, int*, Interval*, std::optional<Interval>*,
                          std::vector<Interval>*, PartsSlot, std::vector<std::vector<double>>*>;

enum class Written {
  usual,     ///< as `when_set`, in `always(…)` as `always`
  always,    ///< null where it is not known
  when_set,  ///< when it differs from what an absent key means
  if_known,  ///< when `known` says so
  never,     ///< read only
};

/// How the parts of a row are written.
enum class Layout {
  one,      ///< the keys of each part below the key: an object, or one of a list
  columns,  ///< a list for each key of a part, as long as there are parts
};

struct FieldText {
  std::string_view unit = "";        ///< in docs
  NumberRange range = kAnyNumber;    ///< of a number
  std::span<const Word> words = {};  ///< all that a text or an enumeration may be; of an enum with a table: those
  std::string_view comment = "";     ///< in YAML; "{NAME}" stands for a substitution
  std::string_view meaning = "";     ///< in docs; the comment when empty
  std::string_view otherwise = "";   ///< in docs: what an absent key means
  Written written = Written::usual;
  /// Of the object: whether the value is known; null, or no key, where it is not (`when<has_value>`).
  bool (*known)(const void* object) = nullptr;
  bool required = false;
  bool quoted = false;                    ///< a word that YAML 1.1 would not take for a text: yes, no
  Entry::Form form = Entry::Form::value;  ///< in YAML, of a list or of a part with rows of its own
};

struct Field {
  /// Empty: an empty line of YAML, or the keys of a part are among those of the object.
  std::string_view key;
  Slot (*slot)(void* object) = nullptr;
  FieldText text = {};
  std::string_view kind = "";  ///< in docs: "number", "text"…
  std::vector<Field> below = {};
  Layout layout = Layout::one;
  bool optional = false;                         ///< the member itself may be empty
  std::optional<Value> constant = std::nullopt;  ///< in place of the slot: always written
  /// In place of the slot, for fields other than a single member.
  void (*read)(const MapReader& at, std::string_view key, void* object) = nullptr;
  void (*write)(const Field& field, const void* object, std::vector<Entry>& out) = nullptr;
};

/// A row of a document about a T; one about a base class of T, too, which begins where T begins.
template <class T>
struct Row {
  Field field;
  Row(Field row) : field(std::move(row)) {}
  template <class Base>
  requires(std::is_base_of_v<Base, T> && !std::is_same_v<Base, T> && !std::is_polymorphic_v<T>)
      Row(const Row<Base>& of_base)
      : field(of_base.field) {}
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

template <class T, class... Ts>
constexpr bool is_one_of(const std::variant<Ts...>*) {
  return (std::is_same_v<T, Ts> || ...);
}

template <class V>
Slot slot_of(V& value) {
  // A pointer to any other number would become one to an object: std::size_t where it has 32 bits.
  static_assert(!std::is_arithmetic_v<V> || is_one_of<V*>(static_cast<const Slot*>(nullptr)));
  if constexpr (std::is_enum_v<V>) {
    return WordSlot{&value, [](const void* at) { return static_cast<int>(*static_cast<const V*>(at)); },
                    [](void* at, int number) { *static_cast<V*>(at) = static_cast<V>(number); }};
  } else if constexpr (std::is_constructible_v<Slot, V*> && !std::is_class_v<V>) {
    return &value;
  } else if constexpr (requires(Slot slot) { std::get<V*>(slot); }) {
    return &value;
  } else {
    return static_cast<void*>(&value);
  }
}

// Of a vector, or of an optional as a vector of none or one.
template <class V>
Slot parts_slot_of(V& value) {
  using Part = typename V::value_type;
  static const Part usual{};
  PartsSlot slot{&value, nullptr, nullptr, nullptr, &usual};
  if constexpr (std::is_same_v<V, std::optional<Part>>) {
    slot.size = [](const void* at) { return std::size_t{static_cast<const V*>(at)->has_value() ? 1U : 0U}; };
    // Not emplace(): clang 14 and 19 ask it too early whether a nested Part can be made.
    slot.resize = [](void* at, std::size_t) { *static_cast<V*>(at) = Part{}; };
    slot.part = [](void* at, std::size_t) -> void* { return &**static_cast<V*>(at); };
  } else {
    slot.size = [](const void* at) { return static_cast<const V*>(at)->size(); };
    slot.resize = [](void* at, std::size_t n) { static_cast<V*>(at)->resize(n); };
    slot.part = [](void* at, std::size_t i) -> void* { return &(*static_cast<V*>(at))[i]; };
  }
  return slot;
}

template <auto First, auto... Rest>
Slot parts_slot_at(void* object) {
  using T = typename MemberOf<decltype(First)>::Class;
  return parts_slot_of(((static_cast<T*>(object)->*First).*....*Rest));
}

/// What a function takes and gives.
template <class Function>
struct GetterOf;
template <class V, class T>
struct GetterOf<V (*)(const T&)> {
  using Class = T;
  using Type = V;
};

/// "text", "number"… of a value.
std::string_view kind_of(const Value& value);

// What is only written is asked for its slots too, and not changed.
template <auto First, auto... Rest>
Slot slot_at(void* object) {
  using T = typename MemberOf<decltype(First)>::Class;
  return slot_of(((static_cast<T*>(object)->*First).*....*Rest));
}

template <auto First, auto... Rest>
using MemberAt =
    std::remove_cvref_t<decltype(((std::declval<typename MemberOf<decltype(First)>::Class&>().*First).*....*Rest))>;

template <class Member>
FieldText with_enum_words(FieldText text) {
  if constexpr (EnumWithTable<Member>)
    if (text.words.empty()) text.words = words_in_fields<Member>();
  return text;
}

std::string_view kind_of(const Slot& slot);

void read(std::span<const Field> rows, const MapReader& at, void* object);
std::vector<Entry> entries(std::span<const Field> rows, const void* object, const void* defaults,
                           const Substitutions& substitutions, bool all = false);

}  // namespace fields_detail

/// A member, or a member of a member: field<&Options::allan, &AllanOptions::tau_min_s>("tau_min_s").
template <auto First, auto... Rest>
auto field(std::string_view key, const FieldText& text = {}) {
  using T = typename fields_detail::MemberOf<decltype(First)>::Class;
  T object{};
  using Member = fields_detail::MemberAt<First, Rest...>;
  Field row{key, &fields_detail::slot_at<First, Rest...>, fields_detail::with_enum_words<Member>(text),
            fields_detail::kind_of(fields_detail::slot_at<First, Rest...>(&object))};
  row.optional = requires(Member member) { member.has_value(); };
  return Row<T>(std::move(row));
}

/// The same, null where the text or the list is empty.
template <auto First, auto... Rest>
auto field_or_null(std::string_view key, FieldText text = {}) {
  using T = typename fields_detail::MemberOf<decltype(First)>::Class;
  text.known = [](const void* object) { return !((static_cast<const T*>(object)->*First).*....*Rest).empty(); };
  return field<First, Rest...>(key, text);
}

/// For `FieldText::known`: Known is bool(const T&), or a lambda without captures like it.
template <auto Known>
bool when(const void* object) {
  using T = typename fields_detail::GetterOf<decltype(+Known)>::Class;
  return Known(*static_cast<const T*>(object));
}

/// What follows from the object and is only written: Get is V(const T&), V a value of a document or a word.
template <auto Get>
auto computed(std::string_view key, const FieldText& text = {}) {
  using Getter = fields_detail::GetterOf<decltype(+Get)>;
  using T = typename Getter::Class;
  using V = std::conditional_t<std::is_convertible_v<typename Getter::Type, std::string_view>, std::string,
                               typename Getter::Type>;
  Field row{key, nullptr, text, fields_detail::kind_of(Value(V{}))};
  row.read = [](const MapReader&, std::string_view, void*) {};
  row.write = [](const Field& f, const void* object, std::vector<Entry>& out) {
    out.push_back({std::string(f.key), Value(V(Get(*static_cast<const T*>(object))))});
  };
  return Row<T>(std::move(row));
}

/// The same, a list of parts with rows of their own: Get is std::vector<Part>(const T&).
template <auto Get, class Part>
auto computed_list(std::string_view key, const Fields<Part>& rows, const FieldText& text = {}) {
  using T = typename fields_detail::GetterOf<decltype(+Get)>::Class;
  Field row{key, nullptr, text, "list", rows.rows};
  row.read = [](const MapReader&, std::string_view, void*) {};
  row.write = [](const Field& f, const void* object, std::vector<Entry>& out) {
    Entry list = part_entry(std::string(f.key), {}, Entry::Form::list);
    const Part usual{};
    for (const Part& part : Get(*static_cast<const T*>(object)))
      list.below.push_back(part_entry("", fields_detail::entries(f.below, &part, &usual, {})));
    out.push_back(std::move(list));
  };
  return Row<T>(std::move(row));
}

/// A list of parts that have rows of their own.
template <auto First, auto... Rest, class Part>
auto list_of(std::string_view key, const Fields<Part>& rows, const FieldText& text = {}) {
  using T = typename fields_detail::MemberOf<decltype(First)>::Class;
  return Row<T>(Field{key, &fields_detail::parts_slot_at<First, Rest...>, text, "list", rows.rows});
}

/// A part that need not be there: an object, or null.
template <auto Member, class Part>
auto maybe_part(std::string_view key, const Fields<Part>& rows, const FieldText& text = {}) {
  using T = typename fields_detail::MemberOf<decltype(Member)>::Class;
  Field row{key, &fields_detail::parts_slot_at<Member>, text, "", rows.rows};
  row.optional = true;
  return Row<T>(std::move(row));
}

/// A list of parts in columns; without a key their lists are among the keys of the object.
template <auto First, auto... Rest, class Part>
auto columns_of(std::string_view key, const Fields<Part>& rows, const FieldText& text = {}) {
  auto row = list_of<First, Rest...>(key, rows, text);
  row.field.layout = Layout::columns;
  return row;
}

/// A key with keys below it, about a member that has rows of its own.
template <auto Member, class Part>
auto part(std::string_view key, const Fields<Part>& rows, const FieldText& text = {}) {
  using T = typename fields_detail::MemberOf<decltype(Member)>::Class;
  return Row<T>(Field{key, &fields_detail::slot_at<Member>, text, "", rows.rows});
}

/// The keys of a part among those of the object.
template <auto Member, class Part>
auto beside(const Fields<Part>& rows) {
  return part<Member>("", rows);
}

/// The same about the object itself: the file has a level that the struct lacks.
template <class T>
Row<T> level(std::string_view key, const Fields<T>& rows, const FieldText& text = {}) {
  return Field{key, [](void* object) -> Slot { return object; }, text, "", rows.rows};
}

/// What every file of a format says; of the words that it may be only checked when read.
template <class T>
Row<T> constant(std::string_view key, Value value, const FieldText& text = {}) {
  Field row{key, nullptr, text};
  row.constant = std::move(value);
  return row;
}

/// "tool": {name, version} of the program that wrote the file.
void read_tool(const MapReader& at, std::string_view key);
template <class T>
Row<T> tool_row() {
  Field row{"tool", nullptr, {.meaning = "the program that wrote the file"}, "`name`, `version`"};
  row.read = [](const MapReader& at, std::string_view key, void*) { read_tool(at, key); };
  row.write = [](const Field& field, const void*, std::vector<Entry>& out) { out.push_back(tool_entry(field.key)); };
  return row;
}

/// An empty line in YAML, before whatever is written next.
template <class T>
Row<T> empty_line() {
  return Field{""};
}

/// Fields other than a single member: Read is void(const MapReader&, std::string_view key, T&), Write is
/// void(const Field&, const T&, std::vector<Entry>&).
template <class T, auto Read, auto Write>
Row<T> custom(std::string_view key, std::string_view kind, const FieldText& text = {}) {
  Field row{key, nullptr, text, kind};
  row.read = [](const MapReader& at, std::string_view name, void* object) { Read(at, name, *static_cast<T*>(object)); };
  row.write = [](const Field& f, const void* object, std::vector<Entry>& out) {
    Write(f, *static_cast<const T*>(object), out);
  };
  return row;
}

/// The same, only written.
template <class T, auto Write>
Row<T> written(std::string_view key, std::string_view kind, const FieldText& text = {}) {
  return custom<T, [](const MapReader&, std::string_view, T&) {}, Write>(key, kind, text);
}

std::vector<std::string> keys_of(std::span<const Field> rows);
template <class T>
std::vector<std::string> keys_of(const Fields<T>& fields) {
  return keys_of(std::span<const Field>(fields.rows));
}

/// Reads the values that are there; a member whose key is absent stays as it is. A number that is null in a
/// report is NaN, where its row does not say what null means (`known`). Throws Error(input).
template <class T>
void read_fields(const Fields<T>& fields, const MapReader& at, T& object) {
  fields_detail::read(fields.rows, at, &object);
}

/// What a file about `object` says.
template <class T>
std::vector<Entry> entries_of(const Fields<T>& fields, const T& object, const Substitutions& substitutions = {}) {
  const T defaults{};
  return fields_detail::entries(fields.rows, &object, &defaults, substitutions);
}

/// The JSON of a document about `object`.
template <class T>
auto document_of(const Fields<T>& fields, const T& object) {
  return json_of(entries_of(fields, object));
}

/// The same rows, written always where they say nothing else.
template <class T>
Fields<T> always(Fields<T> fields) {
  for (Field& row : fields.rows)
    if (row.text.written == Written::usual) row.text.written = Written::always;
  return fields;
}

/// The rows of both.
template <class T>
Fields<T> joined(Fields<T> first, const Fields<T>& second) {
  first.rows.insert(first.rows.end(), second.rows.begin(), second.rows.end());
  return first;
}

/// The rows of these keys in this order, each written always or when it is set.
template <class T>
Fields<T> selected(const Fields<T>& fields, std::initializer_list<std::string_view> keys, Written written) {
  Fields<T> out({});
  for (const std::string_view key : keys)
    for (const Field& row : fields.rows)
      if (row.key == key) out.rows.emplace_back(row).text.written = written;
  return out;
}

/// JSON Schema of an object that these rows describe: types, words, units and meanings; further keys are allowed.
/// `file`: one that people write, where only what is `required` has to be there, and one bare value is a list of one.
Json schema_of(std::span<const Field> rows, bool file = false);

/// "| key | value | meaning |" in Markdown, the rows of a part below it with a dash in front.
std::string markdown_table(std::span<const Field> rows);
template <class T>
std::string markdown_table(const Fields<T>& fields) {
  return markdown_table(std::span<const Field>(fields.rows));
}

}  // namespace libchar
