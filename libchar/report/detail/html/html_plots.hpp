#pragma once
// Empty figures that page.js draws into.

#include <string>
#include <vector>

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
/// The same of several channels, by their indices.
std::string plot_figure(const char* kind,
                        const std::vector<std::size_t>& indices,
                        const PlotText& text,
                        const std::string& of);

/// The record in time, with what was found in it; "" where no samples are.
std::string trace_plot(const ChannelView& channel, std::size_t index, const LogInfo& log);

/// The Allan curves of a group in one figure; "" where there are none.
std::string group_plot(const CharacterizationView& view, const ChannelGroup& group);

/// The Allan and spectrum figures of a channel, as far as there is something to draw.
std::string curve_plots(const ChannelView& channel, std::size_t index);

}  // namespace libchar
