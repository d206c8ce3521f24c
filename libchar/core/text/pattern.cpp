#include "libchar/core/text/pattern.hpp"

#include <algorithm>
#include <cstdint>

#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

bool is_decimal(char c) { return c >= '0' && c <= '9'; }

// Behind the character at `i`; of broken UTF-8 one byte.
std::size_t behind_character(std::string_view text, std::size_t i) {
  std::uint32_t code = 0;
  return i + std::max<std::size_t>(1, decode_utf8(text, i, code));
}

// The digits from `i` on, without leading zeros; `i` ends behind them.
std::string_view number_at(std::string_view text, std::size_t& i) {
  while (i + 1 < text.size() && text[i] == '0' && is_decimal(text[i + 1])) ++i;
  const std::size_t from = i;
  while (i < text.size() && is_decimal(text[i])) ++i;
  return text.substr(from, i - from);
}

}  // namespace

bool is_pattern(std::string_view word) { return word.find_first_of("*?") != std::string_view::npos; }

// The last star takes one character more whenever what follows it does not fit: linear in practice, the
// product of both lengths at worst.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, behind_star = std::string_view::npos, taken = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      behind_star = ++p;
      taken = n;
    } else if (p < pattern.size() && pattern[p] == '?') {
      ++p;
      n = behind_character(name, n);
    } else if (p < pattern.size() && pattern[p] == name[n]) {
      ++p;
      ++n;
    } else if (behind_star != std::string_view::npos) {
      p = behind_star;
      n = taken = behind_character(name, taken);
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

bool comes_before(std::string_view a, std::string_view b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (is_decimal(a[i]) && is_decimal(b[j])) {
      const std::string_view x = number_at(a, i), y = number_at(b, j);
      if (x != y) return x.size() != y.size() ? x.size() < y.size() : x < y;
    } else {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
    }
  }
  if (i == a.size() && j == b.size()) return a < b;  // 01 and 1: one must come first
  return i == a.size();
}

}  // namespace libchar
