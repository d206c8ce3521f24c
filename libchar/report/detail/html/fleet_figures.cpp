
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/charts.hpp"
#include "libchar/report/detail/html/html_tables.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostRows = 200;

std::string many_rows(const Table& table, std::size_t of) {
  return html_table(table, {.css = "many", .of = of, .rest = "lot.json"});
}

/// To a tenth of a degree, without zeros behind it.
std::string celsius(double t) { return brief_text(std::round(10 * t) / 10, 6); }

std::string brackets(const Interval& i, double factor = 1, int digits = 3) {
  return fmt::format("[{}, {}]", number_text(factor * i.low, digits), number_text(factor * i.high, digits));
}

/// "12 % [10, 14]", or "≤ 3 %" where none is seen.
std::string spread_text(double spread, const Interval& ci95, bool logarithm, const std::string& unit) {
  const double factor = logarithm ? 100 : 1;
  const std::string behind = logarithm ? " %" : " " + unit;
  if (!(ci95.low > 0)) return "≤ " + number_text(factor * ci95.high, 3) + behind;
  return number_text(factor * spread, 3) + behind + " " + brackets(ci95, factor);
}

std::string not_counted(const LotCounts& c) {
  std::string out;
  for (const auto& [count, what] : {std::pair(c.not_detected, "not detected"), std::pair(c.doubtful, "doubtful"),
                                    std::pair(c.spoilt, "spoilt by a finding"), std::pair(c.no_result, "without it")})
    if (count > 0) out += fmt::format("{}{} {}", out.empty() ? "" : ", ", count_text(count), what);
  return out;
}

std::string counted_text(const LotCounts& c) {
  return fmt::format("{} of {}", count_text(c.counted), count_text(c.members));
}

std::string mean_text(const std::optional<LotFigures>& f, const std::string& unit) {
  return f ? number_text(f->mean) + " " + brackets(f->mean_ci95, 1, 4) + " " + unit : "–";
}

/// Behind a mean that is not of all, or not only of those counted.
std::string off_text(const QuantityLot& q) {
  if (q.of_all) return fmt::format(", of {}", count_text(q.effects->count));
  if (!q.left_out) return "";
  const double most = 100 * (q.left_out->factor - 1);
  return fmt::format(", too {} by up to {}", in_logarithm(q.quantity) ? "large" : "far from zero",
                     most < 100 ? number_text(most, 2) + " %" : "a factor of " + number_text(q.left_out->factor, 2));
}

std::string channel_unit_text(const std::string& unit) { return unit.empty() ? "U" : unit; }

std::string batches_text(const QuantityLot& q) {
  return q.batch_difference ? probability_text(q.batch_difference->p) : "";
}

std::string ppk_text(const Capability& c) {
  if (!c.ppk) return "";
  if (!std::isfinite(*c.ppk)) return *c.ppk > 0 ? ", no spread seen" : ", all above";
  const auto end = [](double value) { return std::isfinite(value) ? number_text(value, 3) : "∞"; };
  return fmt::format(", Ppk {} [{}, {}]", number_text(*c.ppk, 3), end(c.ppk_ci95.low), end(c.ppk_ci95.high));
}

std::string limit_cell(const QuantityLot& q) {
  if (!q.capability) return "";
  const Capability& c = *q.capability;
  return fmt::format("≤ {}: {} fail, {} not decided{}", limit_text(c.text, c.most, q.unit), count_text(c.fail),
                     count_text(c.not_decided), ppk_text(c));
}

void scale(LotFigures& f, double factor, bool logarithm) {
  f.mean *= factor;
  f.mean_ci95 = {f.mean_ci95.low * factor, f.mean_ci95.high * factor};
  if (logarithm) return;
  f.spread *= factor;
  f.spread_ci95 = {f.spread_ci95.low * factor, f.spread_ci95.high * factor};
}

void scale_logarithms(QuantityLot& q, double shift) {
  if (q.effects) q.effects->mean += shift;
  q.histogram.low += shift;
  if (!q.chart) return;
  q.chart->centre += shift;
  q.chart->limits = {q.chart->limits.low + shift, q.chart->limits.high + shift};
  for (ChartPoint& p : q.chart->points)
    for (double* one : {&p.mean, &p.low, &p.high}) *one += shift;
  for (ChartValue& v : q.chart->beyond) v.value += shift;
}

/// A noise term in the field's unit, where that has a word of its own for it (headline).
QuantityLot in_field_unit(QuantityLot q) {
  const auto term = term_of(q.quantity);
  if (!term || !in_logarithm(q.quantity)) return q;
  const auto [factor, symbol, name, reading] = detail::headline_unit(*term, q.channel_unit);
  if (factor == 1) return q;
  q.unit = symbol;
  if (q.figures) scale(*q.figures, factor, true);
  for (BatchLot& batch : q.batches) {
    if (batch.figures) scale(*batch.figures, factor, true);
    batch.median *= factor;
  }
  if (q.arithmetic) {
    LotFigures all{q.arithmetic->mean, q.arithmetic->mean_ci95, q.arithmetic->sd, q.arithmetic->sd_ci95};
    scale(all, factor, false);
    q.arithmetic = ArithmeticFigures{all.mean, all.mean_ci95, all.spread, all.spread_ci95};
  }
  for (double& quantile : q.quantiles) quantile *= factor;
  if (q.left_out) q.left_out->mean_ci95 = {q.left_out->mean_ci95.low * factor, q.left_out->mean_ci95.high * factor};
  if (q.capability) q.capability->most *= factor;
  scale_logarithms(q, std::log(factor));
  return q;
}

LotAxis axis_of(const QuantityLot& q) {
  LotAxis axis;
  axis.logarithm = in_logarithm(q.quantity);
  axis.title = title_of(q.quantity) + ", " + q.unit;
  if (q.effects) axis.mean = q.effects->mean;
  if (q.capability) axis.limit = std::log(q.capability->most);
  return axis;
}

std::string chart_of(const FleetReport& report, const QuantityLot& q, const std::string& title) {
  std::vector<std::string> beyond;
  for (const ChartValue& v : q.chart->beyond) {
    const double value = in_logarithm(q.quantity) ? std::exp(v.value) : v.value;
    beyond.push_back(report.records[q.charted[v.index]].device + ": " + number_text(value) + " " + q.unit);
  }
  std::vector<ChartBound> bounds;
  for (std::size_t i = 1; i < q.charted.size(); ++i) {
    const std::size_t batch = report.lot->batch_of[q.charted[i]];
    if (batch != report.lot->batch_of[q.charted[i - 1]]) bounds.push_back({i, batch_title(report.lot->batches[batch])});
  }
  // Of very many batches the bounds would be all that is seen.
  if (bounds.size() > 60) bounds.clear();
  return control_figure(*q.chart, q.charted.size(), axis_of(q), beyond, bounds, title);
}

std::string batch_table(const QuantityLot& q) {
  if (q.batches.empty()) return "";
  const bool logarithm = in_logarithm(q.quantity);
  Table out("batch|mean|spread (sd)|median|counted|not counted");
  for (const BatchLot& one : first_of(q.batches, kMostRows))
    out.add({batch_title(one.batch),
             mean_text(one.figures, q.unit) +
                 (one.in_figures > one.counts.counted ? ", of " + count_text(one.in_figures) : ""),
             one.figures ? spread_text(one.figures->spread, one.figures->spread_ci95, logarithm, q.unit) : "–",
             std::isnan(one.median) ? "–" : number_text(one.median) + " " + q.unit, counted_text(one.counts),
             not_counted(one.counts)});
  return folded(fmt::format("{} batches", q.batches.size()), many_rows(out, q.batches.size()));
}

std::string range_text(const Interval& range_c) {
  return fmt::format("{} to {} °C", celsius(range_c.low), celsius(range_c.high));
}

/// How a temperature coefficient was found.
std::string coefficient_sentence(const QuantityLot& q) {
  if (!q.temperatures) return "Found within single recordings with a thermometer, at the mean temperature of each.";
  const TemperatureRuns& t = *q.temperatures;
  std::string out = fmt::format(
      "Slope of the turn-on bias over temperature: {} with {} at {}. Its error comes from the change of the bias at "
      "each switch-on, {} (sd, {} degrees of freedom), not from the noise of one recording.",
      plural(t.devices, "device"), plural(t.recordings, "recording"), range_text(t.range_c),
      spread_text(t.repeatability, t.repeatability_ci95, false, channel_unit_text(q.channel_unit)), t.dof);
  if (t.in_one_recording > 0)
    out +=
        fmt::format(" For {} it was also found within a recording: fewer than have a slope, and not combined with it.",
                    plural(t.in_one_recording, "device"));
  return out;
}

/// At which temperature a turn-on bias is given.
std::string reference_sentence(const QuantityLot& q) {
  const TemperatureRuns& t = *q.temperatures;
  std::string out = fmt::format(
      "{} recorded at {}: their bias is given at {} °C by a line over temperature for each, which is removed from its "
      "repeatability.",
      t.devices == 1 ? "1 device was" : count_text(t.devices) + " devices were", range_text(t.range_c),
      celsius(t.reference_c));
  if (t.elsewhere > 0)
    out += fmt::format(" {} recorded only at one temperature far from that: their bias is the one there.",
                       t.elsewhere == 1 ? "1 device was" : count_text(t.elsewhere) + " devices were");
  if (t.dof < 1)
    out +=
        " The repeatability of the bias is unknown for every device (it takes three recordings, or two at one "
        "temperature), so a temperature coefficient cannot have an error.";
  return out;
}

std::string slope_table(const QuantityLot& q, std::span<const DeviceRecord> records) {
  if (!q.temperatures || q.temperatures->slopes.empty()) return "";
  const std::vector<DeviceSlope>& slopes = q.temperatures->slopes;
  Table out("device|coefficient|recordings|at");
  for (const DeviceSlope& slope : first_of(slopes, kMostRows))
    out.add({records[slope.recording].device, number_text(slope.value) + " " + brackets(slope.ci95) + " " + q.unit,
             count_text(slope.recordings), range_text(slope.temperature_c)});
  return folded(fmt::format("Coefficients of {}", plural(slopes.size(), "device")), many_rows(out, slopes.size()));
}

/// What the mean is worth where devices are missing in it.
std::string left_out_sentence(const QuantityLot& q) {
  const LeftOut& left = *q.left_out;
  const std::size_t missing = q.counts.not_detected + q.counts.doubtful;
  const std::string what = fmt::format("Mean and spread are those of {} devices; {} are excluded ({}). ",
                                       count_text(q.counts.counted), count_text(missing), not_counted(q.counts));
  const std::string of_all =
      fmt::format("[{}, {}] {}", number_text(left.mean_ci95.low), number_text(left.mean_ci95.high), q.unit);
  if (!in_logarithm(q.quantity))
    return what + fmt::format("They are near zero: the mean of all may be up to {} % closer to zero, in {}.",
                              number_text(100 * left.share, 2), of_all);
  return what +
         fmt::format(
             "If those are the smallest, the mean is too large by up to {} %: the mean of all is in {}, and their "
             "spread is at most {} %. Ppk counts the same devices.",
             number_text(100 * (left.factor - 1), 2), of_all, number_text(100 * left.spread_high, 3));
}

/// Which devices the mean covers when some have no value.
std::string of_all_sentence(const QuantityLot& q) {
  return fmt::format(
      "Mean and spread are those of {} of {} devices, undetected or doubtful ones included by the squares measured in "
      "their recordings, as values of a lognormal distribution. Not counted: {}. Histogram, comparison of batches, "
      "chart and outliers use the {} detected ones.",
      count_text(q.effects->count), count_text(q.counts.members), not_counted(q.counts), count_text(q.counts.counted));
}

std::string sentences(const QuantityLot& q) {
  const bool logarithm = in_logarithm(q.quantity);
  std::vector<std::string> out;
  if (q.left_out) out.push_back(left_out_sentence(q));
  if (q.of_all) out.push_back(of_all_sentence(q));
  if (q.arithmetic)
    out.push_back(fmt::format("Arithmetic mean {} {} {}, standard deviation of the devices {}.",
                              number_text(q.arithmetic->mean), brackets(q.arithmetic->mean_ci95, 1, 4), q.unit,
                              spread_text(q.arithmetic->sd, q.arithmetic->sd_ci95, false, q.unit)));
  if (q.quantity == DeviceQuantity::temperature_coefficient)
    out.push_back(coefficient_sentence(q));
  else if (q.temperatures)
    out.push_back(reference_sentence(q));
  if (q.batch_difference) {
    const BatchDifference& d = *q.batch_difference;
    out.push_back(fmt::format("Between batches: {}, {} that equal batches differ as much; within a batch: {}.",
                              spread_text(d.between, d.between_ci95, logarithm, q.unit), probability_text(d.p),
                              number_text((logarithm ? 100 : 1) * d.within, 3) + (logarithm ? " %" : " " + q.unit)));
  }
  if (q.repeats)
    out.push_back(fmt::format("Between recordings of one device: {} ({} devices, {} recordings).",
                              spread_text(q.repeats->within, q.repeats->within_ci95, logarithm, q.unit),
                              count_text(q.repeats->devices), count_text(q.repeats->recordings)));
  if (q.capability) {
    const Capability& c = *q.capability;
    std::string line = "Limit " + limit_cell(q);
    if (c.cpk) line += fmt::format(", Cpk {}", number_text(*c.cpk, 3));
    if (c.ppk) line += fmt::format("; a normal distribution has {} % above", number_text(100 * c.above, 2));
    out.push_back(line + ".");
  }
  return bullet_list(out, "facts");
}

/// Curves of one quantity, in the unit in which the lot compares it: a colour a device, a dash a channel.
struct AllanFigure {
  std::string measures, unit, deviation;
  double to_si = 1;
  std::vector<FigureSeries> curves;
  std::vector<std::string> devices, channels;
};

std::size_t place_in(std::vector<std::string>& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at == names.end()) names.push_back(name);
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// That of the channel where the lot compares nothing in a unit of that kind.
std::optional<Unit> compared_unit(const FleetLot& lot, const Unit& unit) {
  for (const QuantityLot& q : lot.quantities)
    if (const auto own = find_unit(q.channel_unit); own && own->quantity == unit.quantity) return own;
  return unit;
}

AllanFigure& figure_of(const FleetLot& lot, const Channel& channel, std::vector<AllanFigure>& figures) {
  const auto own = find_unit(channel.unit);
  const std::string measures = own                    ? detail::quantity_title(channel.unit)
                               : channel.unit.empty() ? "no unit"
                                                      : "in " + channel.unit;
  const auto at =
      std::find_if(figures.begin(), figures.end(), [&](const AllanFigure& f) { return f.measures == measures; });
  if (at != figures.end()) return *at;
  const std::optional<Unit> unit = own ? compared_unit(lot, *own) : own;
  return figures.emplace_back(AllanFigure{
      measures, unit ? unit->symbol : channel_unit_text(channel.unit), "", unit ? unit->to_si : 1, {}, {}, {}});
}

bool stands_out(const FleetLot& lot, std::size_t recording, std::size_t channel) {
  for (const QuantityLot& q : lot.quantities)
    for (const FleetOutlier& o : q.outliers)
      if (o.recording == recording && (o.channel == channel || o.all_channels)) return true;
  return false;
}

void add_curve(const FleetReport& report, std::size_t recording, std::size_t channel,
               std::vector<AllanFigure>& figures) {
  const ChannelResult& result = report.recordings[recording].channels[channel];
  const auto unit = find_unit(result.channel.unit);
  AllanFigure& figure = figure_of(*report.lot, result.channel, figures);
  figure.deviation = deviation_row(result.allan.type).title;
  const bool strong = stands_out(*report.lot, recording, channel);
  const std::string device = report.records[recording].device + (strong ? " (outlier)" : "");
  const std::size_t known = figure.devices.size(), k = place_in(figure.devices, device);
  const bool alone = report.recordings.size() == 1;  // then a colour a channel
  FigureSeries& curve = figure.curves.emplace_back(allan_series(result.allan, alone ? figure.curves.size() : k,
                                                                result.channel.name + " · " + device, strong,
                                                                unit ? unit->to_si / figure.to_si : 1));
  if (alone) return;
  curve.look.dash += place_in(figure.channels, result.channel.name);
  curve.name = k == known ? device : "";
}

}  // namespace

std::string celsius_text(double t) { return celsius(t) + " °C"; }

std::string group_title(const QuantityLot& q, const FleetLot& lot) {
  const std::string kind = q.of_kind ? detail::quantity_title(q.channel_unit) : "";
  const std::string group = kind.empty() ? q.group : kind + ", " + shown_unit(q.channel_unit);
  return lot.types.size() < 2 ? group : group + " of " + (q.type.empty() ? "no type" : q.type);
}

/// Where the middle 95 % lie; of one device, its value.
std::string devices_text(const QuantityLot& q) {
  if (q.counts.counted == 0) return "–";
  const std::string low = number_text(q.quantiles[1], 3);
  if (q.counts.counted == 1) return fmt::format("{} {}", low, q.unit);
  return fmt::format("{} … {} {}", low, number_text(q.quantiles[5], 3), q.unit);
}

Table quantities_table(const FleetLot& lot, std::optional<bool> of_kind) {
  Table out("group|what|mean|spread (sd)|95 % of devices|counted|not counted|batches alike|limit");
  for (const QuantityLot& own : lot.quantities) {
    if (of_kind && own.of_kind != *of_kind) continue;
    const QuantityLot q = in_field_unit(own);
    const auto spread = [&](const LotFigures& f) {
      return spread_text(f.spread, f.spread_ci95, in_logarithm(q.quantity), q.unit);
    };
    out.add({group_title(q, lot), title_of(q.quantity), mean_text(q.figures, q.unit) + off_text(q),
             q.figures ? spread(*q.figures) : "–", devices_text(q), counted_text(q.counts), not_counted(q.counts),
             batches_text(q), limit_cell(q)});
  }
  return out;
}

std::string allan_figures(const FleetReport& report) {
  std::vector<AllanFigure> figures;
  for (std::size_t r = 0; r < report.recordings.size(); ++r)
    for (std::size_t c = 0; c < report.recordings[r].channels.size(); ++c) add_curve(report, r, c, figures);
  std::string out;
  for (const AllanFigure& f : figures) {
    const std::string drawing =
        curves_figure(f.curves, f.deviation + ", " + f.unit, "Allan curves of all channels, " + f.measures);
    if (drawing.empty()) continue;
    out += "<h3>" + html_text(f.measures) + "</h3>\n" + drawing;
    if (f.channels.size() > 1)
      out += "<p class=\"note\">One colour per device, solid and dashed for its channels: " +
             html_text(fmt::format("{}", fmt::join(f.channels, ", "))) + ".</p>\n";
  }
  return out;
}

std::string quantity_figures(const FleetReport& report, const QuantityLot& own) {
  constexpr std::size_t kFewestDrawn = 4;  // fewer stand in the table, and have no distribution
  if (own.counts.counted < kFewestDrawn) return "";
  const QuantityLot q = in_field_unit(own);
  const std::string title = title_of(q.quantity) + " of " + group_title(q, *report.lot);
  std::string out = "<h3>" + html_text(title) + "</h3>\n<div class=\"plots\">\n" +
                    histogram_figure(q.histogram, axis_of(q), "Histogram: " + title);
  if (q.chart) out += chart_of(report, q, "Control chart: " + title);
  return out + "</div>\n" + sentences(q) + slope_table(q, report.records) + batch_table(q);
}

}  // namespace libchar
