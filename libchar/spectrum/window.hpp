#pragma once
// Window functions.

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

namespace libchar {

enum class Window {
  hann,
  rectangular,
  blackman_harris,
  flat_top,
  hann_nonzero
};  ///< periodic, but hann_nonzero = MATLAB's hanning

std::string_view name_of(Window window);
std::optional<Window> window_named(std::string_view name);
std::vector<double> window_values(Window window, std::size_t n);

}  // namespace libchar
