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
    enum_words<Window>({{Window::hann, "hann"},
                        {Window::rectangular, "rectangular"},
                        {Window::blackman_harris, "blackman_harris"},
                        {Window::flat_top, "flat_top"},
                        {Window::hann_nonzero, "hann_nonzero"}});

std::vector<double> window_values(Window window, std::size_t n);

}  // namespace libchar
