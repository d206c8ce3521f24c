#include "libchar/core/document/schema.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar {
namespace {

std::string place(const std::string& file, int line, int column) {
  return line > 0 ? fmt::format("{}:{}:{}", file, line, column) : file;
}

std::string kind_name(Document::Kind kind) {
  switch (kind) {
    case Document::Kind::null:
      return "nothing";
    case Document::Kind::boolean:
      return "true or false";
    case Document::Kind::number:
      return "a number";
    case Document::Kind::text:
      return "a text";
    case Document::Kind::list:
      return "a list";
    case Document::Kind::map:
      return "a map";
  }
  return "";
}

// What a text that should have been a number might have meant.
std::string number_hint(std::string_view key, const std::string& text) {
  if (text.find(',') != std::string::npos) return "write the decimal mark as a point";
  if (text == ".inf" || text == ".nan" || text == "-.inf") return "it must be finite";
  if (!text.empty() && text[0] == '0') return "write it in decimal, without leading zeros";
  if (text.starts_with('.') || text.starts_with('+')) return "write a digit first, as in 0.5";
  constexpr std::string_view kDigits = "0123456789";
  const bool with_unit = !text.empty() && kDigits.find(text.back()) == std::string_view::npos &&
                         kDigits.find(text[text[0] == '-' ? 1 : 0]) != std::string_view::npos;
  if (!with_unit) return "";
  constexpr std::pair<std::string_view, std::string_view> kUnits[] = {
      {"_c", "°C"}, {"_hz", "Hz"}, {"_s", "s"}, {"_bytes", "bytes"}};
  for (const auto& [ending, unit] : kUnits)
    if (key.ends_with(ending)) return fmt::format("write the number alone: it is in {}", unit);
  return "write the number alone: the unit has a key of its own";
}

template <class T>
std::optional<T> integer(const Document& value) {
  T number{};
  const char* const end = value.text.data() + value.text.size();
  if (value.kind != Document::Kind::number || !value.whole) return std::nullopt;
  const auto r = std::from_chars(value.text.data(), end, number);
  if (r.ec != std::errc() || r.ptr != end) return std::nullopt;
  return number;
}

}  // namespace

std::string shown(const Document& value) {
  if (value.kind == Document::Kind::list || value.kind == Document::Kind::map) return kind_name(value.kind);
  return value.text;
}

MapReader::MapReader(const Document& node, std::string file, std::string path)
    : node_(&node), file_(std::move(file)), path_(std::move(path)), any_keys_(true) {
  if (node.kind != Document::Kind::map)
    throw input_error("E0541", where(node))
        .says("{}expected a map of keys and values, found {}", path_.empty() ? "" : path_ + ": ", kind_name(node.kind))
        .got(node.text);
}

MapReader::MapReader(const Document& node, std::string file, std::string path, std::vector<std::string> keys)
    : MapReader(node, std::move(file), std::move(path)) {
  any_keys_ = false;
  for (const DocumentEntry& entry : node.map) {
    if (std::find(keys.begin(), keys.end(), entry.key) != keys.end()) continue;
    const auto near = nearest(entry.key, keys);
    throw input_error("E0540", place(file_, entry.line, entry.column))
        .says(path_.empty() ? "unknown key" : "unknown key in " + path_)
        .got(entry.key)
        .hint(did_you_mean(near, fmt::format("the keys here are {}", fmt::join(keys, ", "))));
  }
}

const Document* MapReader::get(std::string_view key) const {
  const DocumentEntry* entry = node_->find(key);
  return entry == nullptr || entry->value.kind == Document::Kind::null ? nullptr : &entry->value;
}

bool MapReader::is_null(std::string_view key) const { return any_keys_ && node_->find(key) != nullptr && !has(key); }

const Document& MapReader::require(std::string_view key) const {
  const Document* value = get(key);
  if (value != nullptr) return *value;
  const DocumentEntry* entry = node_->find(key);
  throw input_error("E0542", where(entry != nullptr ? entry->value : *node_)).says("{} is missing", path_of(key));
}

double MapReader::checked(std::string_view key, const Document& value, NumberRange range) const {
  if (value.kind != Document::Kind::number)
    throw input_error("E0541", where(value))
        .says("{}: expected a number, found {}", path_of(key), kind_name(value.kind))
        .got(value.text)
        .hint(number_hint(key, value.text));
  const bool inside =
      value.number <= range.highest && (range.open_low ? value.number > range.lowest : value.number >= range.lowest);
  if (inside) return value.number;
  const bool above = range.highest == std::numeric_limits<double>::max();
  throw input_error("E0543", where(value))
      .says(above ? fmt::format("{}: expected a number {} {}", path_of(key), range.open_low ? "above" : "of at least",
                                shortest(range.lowest))
                  : fmt::format("{}: expected a number from {} to {}", path_of(key), shortest(range.lowest),
                                shortest(range.highest)))
      .got(value.text);
}

double MapReader::number(std::string_view key, NumberRange range) const { return checked(key, require(key), range); }

double MapReader::number_or(std::string_view key, double fallback, NumberRange range) const {
  const Document* value = get(key);
  return value == nullptr ? fallback : checked(key, *value, range);
}

std::optional<double> MapReader::maybe_number(std::string_view key, NumberRange range) const {
  const Document* value = get(key);
  if (value == nullptr) return std::nullopt;
  return checked(key, *value, range);
}

std::uint64_t MapReader::count(std::string_view key, NumberRange range) const {
  const Document& value = require(key);
  const auto natural = integer<std::uint64_t>(value);
  if (!natural)
    throw input_error("E0541", where(value))
        .says("{}: expected a whole number of at least {}", path_of(key), shortest(std::max(range.lowest, 0.0)))
        .got(shown(value));
  checked(key, value, range);
  return *natural;
}

std::int64_t MapReader::whole(std::string_view key) const {
  const Document& value = require(key);
  if (const auto number = integer<std::int64_t>(value)) return *number;
  throw input_error("E0541", where(value))
      .says("{}: expected a whole number of 64 bits", path_of(key))
      .got(shown(value));
}

std::uint64_t MapReader::count_or(std::string_view key, std::uint64_t fallback) const {
  return has(key) ? count(key) : fallback;
}

std::string MapReader::text(std::string_view key) const {
  const Document& value = require(key);
  // A name such as 1, no or true is a name.
  if (value.kind == Document::Kind::list || value.kind == Document::Kind::map)
    throw input_error("E0541", where(value)).says("{}: expected a text, found {}", path_of(key), kind_name(value.kind));
  return value.text;
}

std::string MapReader::text_or(std::string_view key, std::string fallback) const {
  return has(key) ? text(key) : std::move(fallback);
}

bool MapReader::flag_or(std::string_view key, bool fallback) const {
  const Document* value = get(key);
  if (value == nullptr) return fallback;
  if (value->kind == Document::Kind::boolean) return value->boolean;
  throw input_error("E0541", where(*value)).says("{}: expected true or false", path_of(key)).got(shown(*value));
}

std::string MapReader::word(std::string_view key, const std::vector<std::string>& words) const {
  const std::string found = text(key);
  if (std::find(words.begin(), words.end(), found) != words.end()) return found;
  const auto near = nearest(found, words);
  throw input_error("E0544", where(require(key)))
      .says("{}: expected one of {}", path_of(key), fmt::join(words, ", "))
      .got(found)
      .hint(did_you_mean(near));
}

std::pair<double, double> MapReader::interval(std::string_view key) const {
  const Interval ends = interval_in(key, require(key));
  return {ends.low, ends.high};
}

Interval MapReader::interval_in(std::string_view key, const Document& value) const {
  constexpr double kFarthest[] = {-INFINITY, INFINITY};  ///< of an end that is null: the record gives none
  double ends[2] = {};
  bool right = value.kind == Document::Kind::list && value.list.size() == 2;
  for (std::size_t i = 0; i < 2 && right; ++i) {
    const Document& end = value.list[i];
    const bool none = end.kind == Document::Kind::null && (any_keys_ || i == 1);
    ends[i] = none ? kFarthest[i] : end.number;
    right = none || end.kind == Document::Kind::number;
  }
  if (right && ends[0] <= ends[1]) return {ends[0], ends[1]};
  throw input_error("E0543", where(value))
      .says("{}: expected two numbers [low, high], the lower first", path_of(key))
      .got(shown(value));
}

std::vector<double> MapReader::numbers(std::string_view key) const { return numbers_in(key, require(key)); }

std::vector<double> MapReader::numbers_in(std::string_view key, const Document& value) const {
  if (value.kind != Document::Kind::list) return {checked(key, value, kAnyNumber)};
  std::vector<double> out;
  out.reserve(value.list.size());
  for (const Document& element : value.list)
    out.push_back(any_keys_ && element.kind == Document::Kind::null ? kNone : checked(key, element, kAnyNumber));
  return out;
}

std::vector<std::string> MapReader::texts(std::string_view key) const {
  const Document& value = require(key);
  if (value.kind != Document::Kind::list) return {text(key)};
  std::vector<std::string> out;
  for (const Document& element : value.list) {
    if (element.kind == Document::Kind::list || element.kind == Document::Kind::map)
      throw input_error("E0541", where(element)).says("{}: expected texts", path_of(key));
    out.push_back(element.text);
  }
  return out;
}

const std::vector<Document>& MapReader::list(std::string_view key) const {
  const Document& value = require(key);
  if (value.kind == Document::Kind::list) return value.list;
  throw input_error("E0541", where(value))
      .says("{}: expected a list, found {}", path_of(key), kind_name(value.kind))
      .got(value.text);
}

const std::vector<Document>& MapReader::list(std::string_view key, std::size_t length) const {
  const std::vector<Document>& elements = list(key);
  if (elements.size() == length) return elements;
  throw input_error("E0982", where(require(key)))
      .says("{}: {} values, {} expected: one per point of the curve", path_of(key), elements.size(), length)
      .hint("was the report edited? write it again");
}

MapReader MapReader::below(const Document& node, std::string path, std::vector<std::string> keys) const {
  return any_keys_ ? MapReader(node, file_, std::move(path)) : MapReader(node, file_, std::move(path), std::move(keys));
}

MapReader MapReader::map(std::string_view key, std::vector<std::string> keys) const {
  return below(require(key), path_of(key), std::move(keys));
}

std::vector<MapReader> MapReader::maps(std::string_view key, const std::vector<std::string>& keys) const {
  std::vector<MapReader> out;
  for (const Document& node : list(key))
    out.push_back(below(node, fmt::format("{}[{}]", path_of(key), out.size()), keys));
  return out;
}

std::string MapReader::where(const Document& value) const { return place(file_, value.line, value.column); }

std::string MapReader::path_of(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

void MapReader::refuse(std::string_view key, const std::string& what, const std::string& hint) const {
  const DocumentEntry* entry = node_->find(key);
  const Document& at = entry != nullptr ? entry->value : *node_;
  throw input_error("E0545", where(at))
      .says("{}: {}", path_of(key), what)
      .got(entry != nullptr ? at.text : "")
      .hint(hint);
}

void check_format(const Document& document, const std::string& file, std::string_view format, std::uint64_t version) {
  const auto at = [&](const Document& node) { return place(file, node.line, node.column); };
  const std::string begin =
      fmt::format("a {} file begins with \"format: {}\" and \"version: {}\"", format, format, version);
  if (document.kind != Document::Kind::map)
    throw input_error("E0546", document.line > 0 ? at(document) : file)
        .says("is not a " + std::string(format))
        .got(shown(document))
        .hint(begin);
  const DocumentEntry* kind = document.find("format");
  if (kind == nullptr) throw input_error("E0546", at(document)).says("the key format is missing").hint(begin);
  if (kind->value.text != format)
    throw input_error("E0546", at(kind->value)).says("expected the format {}", format).got(shown(kind->value));
  const DocumentEntry* number = document.find("version");
  if (number == nullptr) throw input_error("E0546", at(document)).says("the key version is missing").hint(begin);
  const Document& value = number->value;
  if (value.kind == Document::Kind::number && value.whole && value.number == static_cast<double>(version)) return;
  const bool newer = value.kind == Document::Kind::number && value.whole && value.number > static_cast<double>(version);
  throw input_error("E0546", at(value))
      .says(newer ? fmt::format("version {} of the format {} is newer than this program, which reads {}", value.text,
                                format, version)
                  : fmt::format("expected version: {}", version))
      .got(shown(value))
      .hint(newer ? "update sensorchar" : "");
}

}  // namespace libchar
