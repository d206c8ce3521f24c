#include "libchar/figure/detail/sources/report_values.hpp"

#include <fmt/format.h>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

[[noreturn]] void refuse_length(const MapReader& map,
                                std::string_view key,
                                std::size_t length,
                                std::size_t expected) {
  throw Error({ErrorKind::input,
               "E0982",
               map.where(map.node()),
               fmt::format("{}: {} values, {} expected: one a point of the curve",
                           map.path_of(key),
                           length,
                           expected),
               "",
               "was the report edited? write it again"});
}

std::vector<std::vector<double>> series_of(const MapReader& map,
                                           std::string_view key,
                                           std::size_t length) {
  std::vector<std::vector<double>> out;
  for (const Document& series : map.list(key)) {
    out.push_back(map.numbers_in(key, series));
    if (out.back().size() != length) refuse_length(map, key, out.back().size(), length);
  }
  return out;
}

}  // namespace

std::vector<double> report_numbers(const MapReader& map, std::string_view key, std::size_t length) {
  if (!map.has(key)) return {};
  if (length > 0) map.list(key, length);
  return map.numbers(key);
}

ReportTrack report_track(const MapReader& map,
                         std::string_view key,
                         const std::vector<double>& time_s) {
  ReportTrack out;
  if (!map.has(key)) return out;
  const MapReader track = map.map(key);
  out.time_s = track.has("time_s") ? report_numbers(track, "time_s") : time_s;
  if (track.has("value")) {
    out.low = series_of(track, "value", out.time_s.size());
    out.high = out.low;
    return out;
  }
  out.low = series_of(track, "low", out.time_s.size());
  out.high = series_of(track, "high", out.time_s.size());
  if (out.low.size() != out.high.size())
    refuse_length(track, "high", out.high.size(), out.low.size());
  return out;
}

std::string usual_figure_unit(const std::string& unit) {
  const auto known = find_unit(unit);
  return shown_unit(known && known->symbol != "1" ? known->symbol : unit);
}

}  // namespace libchar
