#include "colour.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace sensorchar {
namespace {

// What was asked for holds for every line that is printed.
Colour g_colour = Colour::automatic;

constexpr std::string_view kPlain = "\x1b[0m";
constexpr std::string_view kGreen = "\x1b[32m", kYellow = "\x1b[33m", kRed = "\x1b[31m",
                           kFaint = "\x1b[2m";

struct ColouredWord {
  std::string_view word, colour;
};

// Longer ones first: "not detected" is not detected.
constexpr ColouredWord kCells[] = {{"not detected", kFaint},
                                   {"not fitted", kFaint},
                                   {"undetermined", kYellow},
                                   {"not decided", kYellow},
                                   {"detected", kGreen},
                                   {"misfit", kRed},
                                   {"pass", kGreen},
                                   {"fail", kRed}};
constexpr ColouredWord kRatings[] = {{"good:", kGreen}, {"look:", kYellow}, {"do not use:", kRed}};

bool stands_alone(std::string_view line, std::size_t at, std::size_t size) {
  const bool before = at >= 2 && line.substr(at - 2, 2) == "  ";
  const std::string_view behind = line.substr(at + size);
  return before && (behind.empty() || behind.starts_with("  "));
}

std::string with_colour(std::string_view line,
                        std::size_t at,
                        std::size_t size,
                        std::string_view colour) {
  std::string out(line.substr(0, at));
  out += colour;
  out += line.substr(at, size);
  out += kPlain;
  out += line.substr(at + size);
  return out;
}

std::string coloured_line(std::string_view line) {
  const std::size_t begin = line.find_first_not_of(' ');
  if (begin == std::string_view::npos) return std::string(line);
  for (const auto& [word, colour] : kRatings)
    if (line.substr(begin).starts_with(word)) return with_colour(line, begin, word.size(), colour);
  for (const auto& [word, colour] : kCells)
    if (const std::size_t at = line.find(word);
        at != std::string_view::npos && stands_alone(line, at, word.size()))
      return with_colour(line, at, word.size(), colour);
  return std::string(line);
}

}  // namespace

void use_colour(Colour colour) {
  g_colour = colour;
}

bool colours(int descriptor) {
  if (g_colour != Colour::automatic) return g_colour == Colour::always;
  const char* term = std::getenv("TERM");
  const char* none = std::getenv("NO_COLOR");
  return (none == nullptr || *none == '\0') && term != nullptr && std::strcmp(term, "dumb") != 0 &&
         ::isatty(descriptor) == 1;
}

std::string coloured_result(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    out += coloured_line(text.substr(0, end));
    if (end < text.size()) out += '\n';
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return out;
}

std::string coloured_message(std::string_view line) {
  for (const auto& [word, colour] :
       {ColouredWord{"error ", kRed}, ColouredWord{"warning", kYellow}})
    if (const std::size_t at = line.find(word); at != std::string_view::npos)
      return with_colour(line, at, word.size() - (word.back() == ' ' ? 1 : 0), colour);
  return std::string(line);
}

}  // namespace sensorchar
