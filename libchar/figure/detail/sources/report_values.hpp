#pragma once
// Values of a report, which may hold nulls where a log or a program had none.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/schema.hpp"

namespace libchar {

/// A list of numbers, NaN where they are null; empty where the key is absent. Of another length
/// than `length` (0: any) it is refused. Throws Error(input) with the place.
std::vector<double> report_numbers(const MapReader& map,
                                   std::string_view key,
                                   std::size_t length = 0);

/// A list of one or more series, each of `length` numbers: smallest and largest values, the same
/// where there is one `value`.
struct ReportTrack {
  std::vector<double> time_s;
  std::vector<std::vector<double>> low, high;
  bool empty() const { return time_s.empty(); }
};
/// Of an object {time_s, low, high}, or {low, high} and {value} whose times stand beside it. Empty
/// where the key is absent or null.
ReportTrack report_track(const MapReader& map,
                         std::string_view key,
                         const std::vector<double>& time_s = {});

/// "deg/s" for what means the same; "U" where there is none; "" for a ratio.
std::string usual_figure_unit(const std::string& unit);

}  // namespace libchar
