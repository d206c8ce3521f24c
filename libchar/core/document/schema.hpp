#pragma once
// Reading a document against what its format allows: every refusal names file, line, key and the nearest valid key.

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/document.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// The numbers that a key accepts; the ends belong to it unless `open` says otherwise.
struct NumberRange {
  double lowest = -std::numeric_limits<double>::max();
  double highest = std::numeric_limits<double>::max();
  bool open_low = false;  ///< lowest itself is refused
};
inline constexpr NumberRange kAnyNumber{};
inline constexpr NumberRange kNotNegative{0, std::numeric_limits<double>::max(), false};
inline constexpr NumberRange kPositive{0, std::numeric_limits<double>::max(), true};

/// One map of a document. The constructor refuses anything but a map and every key outside `keys`.
/// A key whose value is null counts as absent.
class MapReader {
 public:
  MapReader(const Document& node, std::string file, std::string path, std::vector<std::string> keys);
  /// Of a report, which grows keys from version to version: those that nobody asks for are left
  /// alone, here and below, and what is null in a list is NaN.
  MapReader(const Document& node, std::string file, std::string path);

  bool has(std::string_view key) const { return get(key) != nullptr; }
  /// A report says that it has no such value.
  bool is_null(std::string_view key) const;
  const Document* get(std::string_view key) const;
  const Document& require(std::string_view key) const;

  double number(std::string_view key, NumberRange range = kAnyNumber) const;
  double number_or(std::string_view key, double fallback, NumberRange range = kAnyNumber) const;
  std::optional<double> maybe_number(std::string_view key, NumberRange range = kAnyNumber) const;
  std::uint64_t count(std::string_view key, NumberRange range = kNotNegative) const;
  /// A whole number of either sign.
  std::int64_t whole(std::string_view key) const;
  std::uint64_t count_or(std::string_view key, std::uint64_t fallback) const;
  std::string text(std::string_view key) const;
  std::string text_or(std::string_view key, std::string fallback) const;
  bool flag_or(std::string_view key, bool fallback) const;
  /// One of a few words.
  std::string word(std::string_view key, const std::vector<std::string>& words) const;
  /// A list of exactly two numbers, the first below the second.
  std::pair<double, double> interval(std::string_view key) const;
  /// The same, `value` following `key` or in its list; in a report an end may be null: infinite.
  Interval interval_in(std::string_view key, const Document& value) const;
  /// A list of numbers; one bare number is a list of one.
  std::vector<double> numbers(std::string_view key) const;
  /// The same, `value` being in the list after `key`.
  std::vector<double> numbers_in(std::string_view key, const Document& value) const;
  /// A list of texts; one bare text is a list of one.
  std::vector<std::string> texts(std::string_view key) const;
  /// The elements of a list.
  const std::vector<Document>& list(std::string_view key) const;
  /// The same, refused where there are not so many: lists that go together.
  const std::vector<Document>& list(std::string_view key, std::size_t length) const;
  /// The map behind `key`.
  MapReader map(std::string_view key, std::vector<std::string> keys = {}) const;
  /// The maps of the list behind `key`.
  std::vector<MapReader> maps(std::string_view key, const std::vector<std::string>& keys = {}) const;

  /// "FILE:LINE:COL" of a value (FILE when unknown).
  std::string where(const Document& value) const;
  std::string path_of(std::string_view key) const;
  const std::string& file() const { return file_; }
  const Document& node() const { return *node_; }
  /// Throws Error(input): "KEY: WHAT".
  [[noreturn]] void refuse(std::string_view key, const std::string& what, const std::string& hint = "") const;

 private:
  double checked(std::string_view key, const Document& value, NumberRange range) const;
  MapReader below(const Document& node, std::string path, std::vector<std::string> keys) const;

  const Document* node_;
  std::string file_, path_;
  bool any_keys_ = false;
};

/// Checks `format` and `version` of a whole file before anything else of it: another format and a
/// newer version are refused by name. Throws Error(input).
void check_format(const Document& document, const std::string& file, std::string_view format, std::uint64_t version);

/// A number of the file's own, for messages: exactly as written there.
std::string shown(const Document& value);

}  // namespace libchar
