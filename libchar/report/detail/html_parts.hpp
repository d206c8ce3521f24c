#pragma once
// The parts of the page (html_report.cpp puts them together). Every text that reaches the page goes
// through escape.hpp.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// The section of one channel: plots, numbers, trust, data quality, units for consumers, points of
/// the curve.
std::string channel_section(const ChannelView& channel, const LogInfo& log, std::size_t index);

struct PlotText {
  std::string title, axis, unit, caption;  ///< `axis`: short, the title says it in full
};

/// An empty figure for page.js to draw `kind` into (html_plots.cpp).
std::string plot_figure(const char* kind,
                        std::size_t index,
                        const PlotText& text,
                        const std::string& channel);

/// The Allan and spectrum figures of a channel, as far as there is something to draw.
std::string curve_plots(const ChannelView& channel, std::size_t index);

/// A table row of cells, each escaped as text; the first is a row header.
std::string table_row(const std::vector<std::string>& cells);
std::string table_head(const std::vector<std::string>& cells);
/// "<ul>…": nothing when there is no item.
std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class);

}  // namespace libchar
