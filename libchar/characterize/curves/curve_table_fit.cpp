#include "libchar/characterize/curves/curve_table_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/fit/curve/curve_fit.hpp"
#include "libchar/fit/curve/curve_table.hpp"
#include "libchar/log/reading_fields.hpp"

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
    throw input_error("E0803", path).says("a curve needs two columns: averaging time or frequency, and values");
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

bool stands_for(const std::string& word, const std::string& name) {
  return word == name || (is_pattern(word) && matches(word, name));
}

void refuse_unknown(const std::string& path, const CurveTable& named, const std::vector<std::string>& wanted) {
  std::vector<std::string> names;
  for (const NamedCurve& n : named.curves) names.push_back(n.name);
  for (const std::string& word : wanted)
    if (std::none_of(names.begin(), names.end(), [&](const std::string& name) { return stands_for(word, name); }))
      throw usage_error("E0320", path)
          .says("no curve of this name")
          .got(word)
          .hint(did_you_mean(nearest(word, names), "it has " + first_names(names)));
}

Table named_table(const std::string& path, const CurveTable& named, const ReadOptions& reading) {
  const std::vector<std::string>& wanted = reading.channels;
  Table table;
  table.info.file = path;
  table.info.bytes = named.bytes;
  table.info.sha256 = named.sha256;
  for (const std::string& option : options_given(reading))
    if (option != "channels" && option != "units" && option != "rate_hz")
      throw usage_error("E0336", "`" + option + "`")
          .says("has no effect on a table of curves with names")
          .hint("leave it out");
  refuse_unknown(path, named, wanted);
  for (const NamedCurve& n : named.curves) {
    const auto means_it = [&](const std::string& word) { return stands_for(word, n.name); };
    if (!wanted.empty() && std::none_of(wanted.begin(), wanted.end(), means_it)) continue;
    table.channels.push_back({n.name, n.unit, false});
    table.curves.push_back(n.curve);
  }
  for (std::size_t c = 0; c < table.channels.size() && !reading.units.empty(); ++c)
    table.channels[c].unit = reading.units[std::min(c, reading.units.size() - 1)];
  return table;
}

}  // namespace

CurveTableFit fit_curve_table(const std::string& path, const CurveTableOptions& options, Progress& progress) {
  const auto named = read_curve_table(path, options.is_allan);
  Table table = named ? named_table(path, *named, options.reading) : unnamed_table(path, options, progress);
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
