#pragma once
// Counted diagnostics: what was found dirty but usable, and what was done about it.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace libchar {

struct Warning {
  std::string code;     ///< stable key of the kind, snake_case, e.g. "duplicate_timestamp"
  std::string message;  ///< what was found and what was done about it, without the count
  std::uint64_t count = 0;
  std::vector<std::string> places;  ///< the first three, e.g. "line 412"
};

/// Warnings in the order in which their kinds first appeared.
class Warnings {
 public:
  /// Counts `count` more cases of the kind `code`. The message of the first call for a code is kept.
  void add(std::string_view code,
           std::string_view message,
           std::string_view place = {},
           std::uint64_t count = 1);
  void merge(const Warnings& other);
  const std::vector<Warning>& list() const { return list_; }
  bool empty() const { return list_.empty(); }
  const Warning* find(std::string_view code) const;

 private:
  Warning& entry(std::string_view code, std::string_view message);
  std::vector<Warning> list_;
};

/// "3 × MESSAGE (first: line 412, line 413, line 9001)", control characters escaped.
std::string sentence_of(const Warning& warning);
/// "FILE: warning: 3 × MESSAGE (first: line 412, line 413, line 9001)", control characters escaped.
std::string one_line(const Warning& warning, std::string_view file, bool colours = false);

}  // namespace libchar
