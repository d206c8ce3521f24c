#pragma once
// The parts of the page (html_report.cpp puts them together). Every text that reaches the page goes
// through escape.hpp.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/report/characterization.hpp"

namespace libchar {

/// The section of one channel: plots, numbers, trust, data quality, units for consumers, points of
/// the curve.
std::string channel_section(const ChannelResult& channel, const LogInfo& log, std::size_t index);

/// A table row of cells, each escaped as text; the first is a row header.
std::string table_row(const std::vector<std::string>& cells);
std::string table_head(const std::vector<std::string>& cells);
/// "<ul>…": nothing when there is no item.
std::string bullet_list(const std::vector<std::string>& items, std::string_view css_class);

}  // namespace libchar
