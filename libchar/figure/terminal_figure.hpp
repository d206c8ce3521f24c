#pragma once
// A figure in a terminal: braille dots, two by four in a character.

#include <cstddef>
#include <string>

#include "libchar/figure/figure.hpp"

namespace libchar {

struct TerminalFigureOptions {
  std::size_t columns = 80;  ///< of the terminal
  std::size_t rows = 20;     ///< of the plot, without axis and legend
  bool colour = false;       ///< escapes of ECMA-48
};

/// Lines that end in a newline, none wider than `columns` (at least 40). Each series has a letter
/// where there are several, and a colour.
std::string terminal_figure(const Chart& figure, const TerminalFigureOptions& options);

}  // namespace libchar
