#include "libchar/log/ros/messages/message_definition.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "libchar/core/text/text.hpp"
#include "libchar/log/detail/column_name.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostFields = 100000;          // of all types of a text
constexpr std::uint64_t kLongestArray = 1000000000;  // of a fixed array

struct PrimitiveName {
  std::string_view name;
  Primitive kind;
};

constexpr std::array kPrimitives = {
    PrimitiveName{"bool", Primitive::boolean},     PrimitiveName{"byte", Primitive::u8},
    PrimitiveName{"char", Primitive::u8},          PrimitiveName{"int8", Primitive::i8},
    PrimitiveName{"uint8", Primitive::u8},         PrimitiveName{"int16", Primitive::i16},
    PrimitiveName{"uint16", Primitive::u16},       PrimitiveName{"int32", Primitive::i32},
    PrimitiveName{"uint32", Primitive::u32},       PrimitiveName{"int64", Primitive::i64},
    PrimitiveName{"uint64", Primitive::u64},       PrimitiveName{"float32", Primitive::f32},
    PrimitiveName{"float64", Primitive::f64},      PrimitiveName{"string", Primitive::text},
    PrimitiveName{"wstring", Primitive::wide_text}};

bool name_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

// "[]", "[9]", "[<=9]" behind a type. False when it is none of them.
bool read_repeat(std::string_view brackets, MessageField& field) {
  const std::string_view inside = brackets.substr(1, brackets.size() - 2);
  if (inside.empty() || inside.starts_with("<=")) {
    field.repeat = Repeat::variable;
    return true;
  }
  field.repeat = Repeat::fixed;
  const auto [end, code] = std::from_chars(inside.data(), inside.data() + inside.size(), field.count);
  return code == std::errc() && end == inside.data() + inside.size() && field.count <= kLongestArray;
}

// The type of a field without brackets and bounds.
void read_type(std::string_view word, std::string_view package, bool ros1, MessageField& field) {
  for (const PrimitiveName& known : kPrimitives)
    if (known.name == word) {
      field.kind = known.kind;
      return;
    }
  if (ros1 && (word == "time" || word == "duration")) {
    field.kind = word == "time" ? Primitive::time1 : Primitive::duration1;
    return;
  }
  field.type = word == "Header"                           ? "std_msgs/Header"
               : word.find('/') == std::string_view::npos ? fmt::format("{}/{}", package, word)
                                                          : plain_type_name(word);
  const bool stamp = field.type == "builtin_interfaces/Time" || field.type == "builtin_interfaces/Duration";
  field.kind = stamp ? Primitive::time : Primitive::message;
}

// A line without its comment: a field, or nothing (a constant, an empty line). False when it is neither.
bool read_line(std::string_view line, std::string_view package, bool ros1, MessageType& type) {
  line = trimmed(line.substr(0, line.find('#')));
  if (line.empty()) return true;
  const std::size_t end = std::min(line.find_first_of(" \t"), line.size());
  std::string_view word = line.substr(0, end);
  std::string_view rest = trimmed(line.substr(end));
  std::size_t letters = 0;
  while (letters < rest.size() && name_letter(rest[letters])) ++letters;
  if (letters == 0) return false;
  const std::string_view behind = trimmed(rest.substr(letters));
  if (behind.starts_with('=')) return true;  // a constant
  MessageField field;
  field.name = rest.substr(0, letters);
  if (word.ends_with(']')) {
    const std::size_t open = word.rfind('[');
    if (open == std::string_view::npos || !read_repeat(word.substr(open), field)) return false;
    word = word.substr(0, open);
  }
  word = word.substr(0, word.find("<="));
  if (word.empty()) return false;
  read_type(word, package, ros1, field);
  type.fields.push_back(std::move(field));
  return true;
}

std::string_view package_of(std::string_view type) { return type.substr(0, type.find('/')); }

bool parting_line(std::string_view line) {
  return line.size() >= 20 && std::all_of(line.begin(), line.end(), [](char c) { return c == '='; });
}

}  // namespace

std::string plain_type_name(std::string_view type) {
  const std::size_t first = type.find('/'), last = type.rfind('/');
  if (first == std::string_view::npos) return std::string(type);
  return fmt::format("{}/{}", type.substr(0, first), type.substr(last + 1));
}

std::string add_message_types(std::string_view type, std::string_view text, bool ros1, MessageTypes& types) {
  std::vector<MessageType> found(1);
  found.back().name = plain_type_name(type);
  std::size_t fields = 0;
  bool parted = false;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    if (line.ends_with('\r')) line.remove_suffix(1);
    line = trimmed(line);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (parting_line(line)) {
      parted = true;
      continue;
    }
    if (parted && line.starts_with("MSG:")) {
      found.emplace_back().name = plain_type_name(trimmed(line.substr(4)));
      parted = false;
      continue;
    }
    if (!read_line(line, package_of(found.back().name), ros1, found.back()))
      return fmt::format("its definition cannot be read (\"{}\")", printable(line, 40));
    if (++fields > kMostFields) return fmt::format("a definition of more than {} lines", kMostFields);
  }
  for (MessageType& one : found) {
    std::string name = one.name;
    types.try_emplace(std::move(name), std::move(one));
  }
  return "";
}

}  // namespace libchar
