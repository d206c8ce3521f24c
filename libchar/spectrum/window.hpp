#pragma once
// Window functions.

#include <cstddef>
#include <vector>

#include "libchar/core/document/enum_table.hpp"

namespace libchar {

enum class Window {
  hann,
  rectangular,
  blackman_harris,
  flat_top,
  hann_nonzero
};  ///< periodic, but hann_nonzero = MATLAB's hanning

template <>
inline constexpr auto enum_table<Window> =
    enum_words<Window, "hann rectangular blackman_harris flat_top hann_nonzero">;

std::vector<double> window_values(Window window, std::size_t n);

}  // namespace libchar
