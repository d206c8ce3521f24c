#include "libchar/characterize/curve_table_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/fit/curve_fit.hpp"
#include "libchar/fit/curve_table.hpp"

namespace libchar {
namespace {

struct Table {
  LogInfo info;
  std::vector<Channel> channels;
  std::vector<DigitisedCurve> curves;
};

Table unnamed_table(const std::string& path, const CurveTableOptions& options, Progress& progress) {
  ReadOptions reading = options.reading;
  reading.time_column = "none";
  reading.rate_hz = 1;  // rows of a curve have no time
  const Recording read = read_recording(path, reading, progress);
  if (read.samples.size() < 2)
    throw Error({ErrorKind::input,
                 "E0803",
                 path,
                 "a curve needs two columns: averaging time or frequency, and values",
                 "",
                 ""});
  Table table{read.info, {}, {}};
  for (std::size_t c = 1; c < read.samples.size(); ++c) {
    DigitisedCurve curve;
    curve.root = options.is_allan;
    for (std::size_t i = 0; i < read.samples[0].size(); ++i) {
      if (std::isnan(read.samples[0][i]) || std::isnan(read.samples[c][i])) continue;
      curve.x.push_back(read.samples[0][i]);
      curve.y.push_back(read.samples[c][i]);
    }
    table.channels.push_back(read.info.channels[c]);
    table.curves.push_back(curve);
  }
  return table;
}

Table named_table(const std::string& path, const CurveTable& named, const ReadOptions& reading) {
  const std::vector<std::string>& wanted = reading.channels;
  Table table;
  table.info.file = path;
  table.info.bytes = named.bytes;
  table.info.sha256 = named.sha256;
  for (const NamedCurve& n : named.curves) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), n.name) == wanted.end())
      continue;
    table.channels.push_back({n.name, n.unit, false});
    table.curves.push_back(n.curve);
  }
  if (table.curves.empty())
    throw Error({ErrorKind::usage,
                 "E0320",
                 path,
                 "no curve of this name",
                 wanted.front(),
                 "the first one is " + named.curves.front().name});
  for (std::size_t c = 0; c < table.channels.size() && !reading.units.empty(); ++c)
    table.channels[c].unit = reading.units[std::min(c, reading.units.size() - 1)];
  return table;
}

}  // namespace

CurveTableFit fit_curve_table(const std::string& path,
                              const CurveTableOptions& options,
                              Progress& progress) {
  const auto named = read_curve_table(path, options.is_allan);
  Table table =
      named ? named_table(path, *named, options.reading) : unnamed_table(path, options, progress);
  CurveTableFit out{table.info, {}};
  for (std::size_t c = 0; c < table.curves.size(); ++c) {
    DigitisedCurve& curve = table.curves[c];
    curve.is_allan = options.is_allan;
    curve.sides = options.sides;
    if (options.root) curve.root = *options.root;
    curve.duration_s = options.duration_s;
    curve.rate_hz = options.reading.rate_hz;
    out.channels.push_back({table.channels[c], fit_curve(curve, options.fit)});
  }
  return out;
}

}  // namespace libchar
