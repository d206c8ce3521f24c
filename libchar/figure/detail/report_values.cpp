#include "libchar/figure/detail/report_values.hpp"

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

[[noreturn]] void refuse_value(const MapReader& map,
                               std::string_view key,
                               const Document& value,
                               const char* expected) {
  throw Error({ErrorKind::input,
               "E0982",
               map.where(value),
               fmt::format("{}: {} was expected", map.path_of(key), expected),
               value.text,
               ""});
}

const std::vector<Document>& list_in(const MapReader& map,
                                     std::string_view key,
                                     const Document& node,
                                     std::size_t length) {
  if (node.kind != Document::Kind::list) refuse_value(map, key, node, "a list");
  if (length > 0 && node.list.size() != length) refuse_length(map, key, node.list.size(), length);
  return node.list;
}

std::vector<std::vector<double>> series_of(const MapReader& map,
                                           std::string_view key,
                                           std::size_t length) {
  std::vector<std::vector<double>> out;
  for (const Document& series : map.list(key))
    out.push_back(report_numbers(map, key, series, length));
  return out;
}

}  // namespace

MapReader open_report(const Document& node, const std::string& file, const std::string& path) {
  std::vector<std::string> keys;
  for (const DocumentEntry& entry : node.map) keys.push_back(entry.key);
  return {node, file, path, std::move(keys)};
}

MapReader open_report(const MapReader& map, std::string_view key) {
  return open_report(map.require(key), map.file(), map.path_of(key));
}

std::vector<MapReader> open_reports(const MapReader& map, std::string_view key) {
  std::vector<MapReader> out;
  std::size_t i = 0;
  for (const Document& one : map.list(key))
    out.push_back(open_report(one, map.file(), fmt::format("{}[{}]", map.path_of(key), i++)));
  return out;
}

std::vector<double> report_numbers(const MapReader& map,
                                   std::string_view key,
                                   const Document& list,
                                   std::size_t length) {
  std::vector<double> out;
  const std::vector<Document>& values = list_in(map, key, list, length);
  out.reserve(values.size());
  for (const Document& value : values) {
    if (value.kind != Document::Kind::number && value.kind != Document::Kind::null)
      refuse_value(map, key, value, "a number");
    out.push_back(value.kind == Document::Kind::number ? value.number : kNone);
  }
  return out;
}

std::vector<double> report_numbers(const MapReader& map, std::string_view key, std::size_t length) {
  const Document* list = map.get(key);
  if (list == nullptr) return {};
  return report_numbers(map, key, *list, length);
}

std::vector<bool> report_flags(const MapReader& map, std::string_view key, std::size_t length) {
  const Document* list = map.get(key);
  if (list == nullptr) return {};
  std::vector<bool> out;
  for (const Document& value : list_in(map, key, *list, length)) {
    if (value.kind != Document::Kind::boolean) refuse_value(map, key, value, "true or false");
    out.push_back(value.boolean);
  }
  return out;
}

ReportIntervals report_intervals(const MapReader& map, std::string_view key, std::size_t length) {
  ReportIntervals out;
  const Document* list = map.get(key);
  if (list == nullptr) return out;
  for (const Document& pair : list_in(map, key, *list, length)) {
    if (pair.kind == Document::Kind::null) {
      out.low.push_back(kNone);
      out.high.push_back(kNone);
      continue;
    }
    const std::vector<double> ends = report_numbers(map, key, pair, 2);
    out.low.push_back(ends[0]);
    out.high.push_back(ends[1]);
  }
  return out;
}

ReportTrack report_track(const MapReader& map,
                         std::string_view key,
                         const std::vector<double>& time_s) {
  ReportTrack out;
  if (!map.has(key)) return out;
  const MapReader track = open_report(map, key);
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
