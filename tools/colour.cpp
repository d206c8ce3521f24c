#include "colour.hpp"

#include <unistd.h>

#include <cstdlib>
#include <cstring>

namespace sensorchar {
namespace {

// What was asked for holds for every line that is printed.
Colour g_colour = Colour::automatic;

}  // namespace

void use_colour(Colour colour) { g_colour = colour; }

bool colours(int descriptor) {
  if (g_colour != Colour::automatic) return g_colour == Colour::always;
  const char* term = std::getenv("TERM");
  const char* none = std::getenv("NO_COLOR");
  return (none == nullptr || *none == '\0') && term != nullptr && std::strcmp(term, "dumb") != 0 &&
         ::isatty(descriptor) == 1;
}

}  // namespace sensorchar
