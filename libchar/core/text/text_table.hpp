#pragma once
// Tables for a terminal.

#include <string>
#include <string_view>
#include <vector>

namespace libchar {

/// How a text of results is to look: broken at `width` characters (0: any width), its statuses in colour or not.
struct TextLook {
  std::size_t width = 0;
  bool colours = false;
};

/// Meaning of a word for its context: green, yellow, red, pale.
enum class Tint { good, doubtful, bad, absent };
/// The word in its colour where colours are wanted.
std::string tinted(std::string_view word, Tint tint, bool colours);

/// Characters, not bytes: "°" takes one place on a terminal, a colour none.
std::size_t width_of(std::string_view text);

/// The text broken between words into lines of at most `width` characters, `indent` before each and counted; a
/// word that is longer than a line is alone. No newline at the end.
std::string wrapped(std::string_view text, std::size_t width, std::string_view indent = "");

}  // namespace libchar
