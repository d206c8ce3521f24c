#pragma once
// What the tests of pages look at.

#include <cstddef>
#include <string>

namespace test {

/// How often a word stands in a text.
inline std::size_t count(const std::string& text, const std::string& word) {
  std::size_t n = 0;
  for (std::size_t at = 0; (at = text.find(word, at)) != std::string::npos; at += word.size()) ++n;
  return n;
}

}  // namespace test
