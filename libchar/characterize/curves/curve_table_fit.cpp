#include "libchar/characterize/curves/curve_table_fit.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/fit/curve/curve_fit.hpp"
#include "libchar/fit/curve/curve_table.hpp"
#include "libchar/log/reading_fields.hpp"
#include "libchar/spectrum/spectrum_words.hpp"

namespace libchar {
namespace {

struct Table {
  LogInfo info;
  std::vector<Channel> channels;
  std::vector<DigitisedCurve> curves;
  std::vector<std::vector<Finding>> findings = {};  // of each curve
};

/// A deviation whose square is not the Allan variance (hdev, mdev, totdev) has other coefficients.
bool is_allan_curve(const NamedCurve& named) {
  const auto type = deviation_type(named.kind);
  return !type || deviation_row(*type).is_allan();
}

void refuse_power_spectrum(const std::string& path, const std::string& name, const std::string& unit) {
  throw input_error("E0803", path)
      .says("{}: the unit {} is not that of a density", name, unit)
      .hint("a fit needs densities, which psd writes with `scaling` psd; `quantity` power or root says that these are");
}

/// What the unit behind a name says of a spectrum: that of its channel, and whether the values are roots.
void take_unit(const std::string& path, bool told, Channel& channel, DigitisedCurve& curve) {
  const detail::SpectrumValues values = detail::values_of_unit(channel.unit);
  const bool density = values.scaling == Scaling::psd || values.scaling == Scaling::lsd;
  if (!density && !told && !channel.unit.empty()) refuse_power_spectrum(path, channel.name, channel.unit);
  curve.root = values.scaling == Scaling::lsd;
  channel.unit = values.unit;
}

void note_zeros(LogInfo& table, std::uint64_t rows) {
  if (rows > 0)
    table.warnings.add("zero_frequency", "the value at 0 Hz is that of the mean, not of noise; it was left out", "",
                       rows);
}

Table unnamed_table(const std::string& path, const CurveTableOptions& options, Progress& progress) {
  ReadOptions reading = options.reading;
  reading.time_column = "none";
  reading.rate_hz = 1;  // rows of a curve have no time
  const Recording read = read_recording(path, reading, progress);
  if (read.samples.size() < 2)
    throw input_error("E0803", path).says("a curve needs two columns: averaging time or frequency, and values");
  Table table{read.info, {}, {}};
  const double to_si = detail::abscissa_factor(read.info.channels[0].unit, options.is_allan);
  for (std::size_t c = 1; c < read.samples.size(); ++c) {
    DigitisedCurve curve;
    curve.root = options.is_allan;
    for (std::size_t i = 0; i < read.samples[0].size(); ++i) {
      const double x = to_si * read.samples[0][i];
      if (std::isnan(x) || std::isnan(read.samples[c][i])) continue;
      if (x < 0 && !options.is_allan) curve.sides = Sides::two;  // its other half is the same
      if (x <= 0 && !options.is_allan) continue;
      curve.x.push_back(x);
      curve.y.push_back(read.samples[c][i]);
    }
    table.channels.push_back(read.info.channels[c]);
    if (!options.is_allan) take_unit(path, options.root.has_value(), table.channels.back(), curve);
    table.curves.push_back(curve);
  }
  if (!options.is_allan)
    note_zeros(table.info, static_cast<std::uint64_t>(std::count(read.samples[0].begin(), read.samples[0].end(), 0.0)));
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

Table named_table(const std::string& path, const CurveTable& named, const CurveTableOptions& options) {
  const ReadOptions& reading = options.reading;
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
    if (options.is_allan && !is_allan_curve(n)) continue;
    const auto kind = detail::spectrum_kind(n.kind);
    if (kind && (kind->scaling == Scaling::ps || kind->scaling == Scaling::ls) && !options.root)
      refuse_power_spectrum(path, n.name, n.value_unit);
    table.channels.push_back({n.name, n.unit, false});
    table.curves.push_back(n.curve);
    table.findings.push_back(n.findings);
  }
  if (table.curves.empty())
    throw input_error("E0802", path)
        .says("the table holds no Allan deviation, but {}", named.curves.front().kind)
        .hint("a fit needs the deviations of `type` oadev or adev");
  note_zeros(table.info, named.at_zero);
  for (std::size_t c = 0; c < table.channels.size() && !reading.units.empty(); ++c)
    table.channels[c].unit = reading.units[std::min(c, reading.units.size() - 1)];
  return table;
}

}  // namespace

CurveTableFit fit_curve_table(const std::string& path, const CurveTableOptions& options, Progress& progress) {
  const auto named = read_curve_table(path, options.is_allan);
  Table table = named ? named_table(path, *named, options) : unnamed_table(path, options, progress);
  CurveTableFit out{table.info, {}};
  for (std::size_t c = 0; c < table.curves.size(); ++c) {
    DigitisedCurve& curve = table.curves[c];
    curve.is_allan = options.is_allan;
    if (options.sides == Sides::two) curve.sides = Sides::two;  // else as the table says
    if (options.root) curve.root = *options.root;
    curve.duration_s = options.duration_s;
    curve.rate_hz = options.reading.rate_hz;
    out.channels.push_back({table.channels[c], fit_curve(curve, options.fit)});
    std::vector<Finding>& known = out.channels.back().fit.findings;
    if (c < table.findings.size()) known.insert(known.end(), table.findings[c].begin(), table.findings[c].end());
  }
  return out;
}

}  // namespace libchar
