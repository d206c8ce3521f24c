#pragma once
// Empty figures that page.js draws into.

#include <string>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

struct PlotText {
  std::string title, axis, unit, caption;  ///< `axis`: short, the title says it in full
};

/// An empty figure for page.js to draw `kind` into.
std::string plot_figure(const char* kind,
                        std::size_t index,
                        const PlotText& text,
                        const std::string& channel);

/// The Allan and spectrum figures of a channel, as far as there is something to draw.
std::string curve_plots(const ChannelView& channel, std::size_t index);

}  // namespace libchar
