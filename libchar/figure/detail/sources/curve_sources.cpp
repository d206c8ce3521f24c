
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/characterize/curves/model_curve.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/units.hpp"
#include "libchar/figure/detail/figure_parts.hpp"
#include "libchar/fit/curve/curve_table.hpp"
#include "libchar/fit/curve/power_laws.hpp"
#include "libchar/fit/fit_json.hpp"
#include "libchar/log/text_table.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/spectrum_words.hpp"

namespace libchar {
namespace {

SourceCurve::Statistic statistic_of(DeviationType type) {
  const DeviationRow& row = deviation_row(type);
  const bool is_allan = row.order == 2 && !row.of_sum && !row.as_time && row.family == DeviationFamily::differences;
  return {std::string(row.title), is_allan};
}

SourceCurve::Statistic statistic_of(const std::string& word) {
  if (word.empty()) return statistic_of(DeviationType::adev);
  const auto type = deviation_type(word);
  return type ? statistic_of(*type) : SourceCurve::Statistic{word};
}

void add_ends(SourceCurve& curve, const std::vector<Interval>& intervals) {
  for (const Interval& ends : intervals) {
    curve.low95.push_back(ends.low);
    curve.high95.push_back(ends.high);
  }
}

SourceCurve::Statistic line_statistic(const std::string& kind) {
  // "psd_one_sided" of curves.csv
  if (const auto known = detail::spectrum_kind(kind)) return spectrum_statistic(known->sides, known->scaling);
  return {kind.empty() ? "Power spectral density" : kind};
}

}  // namespace

SourceCurve::Statistic spectrum_statistic(Sides sides, Scaling scaling) {
  std::string word(name_of(scaling));
  std::transform(word.begin(), word.end(), word.begin(), [](char c) { return static_cast<char>(c - 'a' + 'A'); });
  return {(sides == Sides::one ? "One-sided " : "Two-sided ") + word, false,
          scaling == Scaling::psd || scaling == Scaling::ps};
}

std::string mark_text(Term term, double value, const std::string& unit) {
  const auto& name = kTermNames[static_cast<std::size_t>(term)];
  const std::string shown = shown_term_unit(name.key, unit == "U" ? "" : unit);
  return fmt::format("{} = {}{}", name.letter, number_text(value, 3), shown.empty() ? "" : " " + shown);
}

void add_allan_curves(FigureSource& out, const MapReader& document) {
  const AllanDocument read = read_allan(document);
  for (const AllanOfChannel& channel : read.channels) {
    if (channel.curve.points.empty()) continue;
    SourceCurve curve = source_curve(channel.name, channel.unit, channel.curve);
    curve.statistic = statistic_of(channel.type.empty() ? read.type : channel.type);
    curve.value_unit = channel.value_unit.empty() ? curve.unit : usual_figure_unit(channel.value_unit);
    curve.model = channel.predicted.model;
    curve.lines = channel.predicted.asymptotes;
    curve.data_sheet = channel.data_sheet;
    out.curves.push_back(std::move(curve));
  }
}

void add_spectra(FigureSource& out, const MapReader& document) {
  const SpectrumDocument read = read_spectra(document);
  const auto sides = find_enum<Sides>(read.sides);
  const auto scaling = find_enum<Scaling>(read.scaling);
  for (const SpectrumOfChannel& channel : read.channels) {
    if (channel.spectrum.frequency_hz.empty()) continue;
    SourceCurve curve;
    curve.channel = channel.name;
    curve.unit = usual_figure_unit(channel.unit);
    curve.is_allan = false;
    curve.statistic = sides && scaling ? spectrum_statistic(*sides, *scaling)
                                       : SourceCurve::Statistic{read.sides + " " + read.scaling};
    curve.value_unit =
        channel.value_unit.empty() ? spectrum_unit(scaling.value_or(Scaling::psd), curve.unit) : channel.value_unit;
    curve.x = channel.spectrum.frequency_hz;
    curve.y = channel.spectrum.value;
    add_ends(curve, channel.ci95);
    curve.model = channel.predicted.model;
    curve.lines = channel.predicted.asymptotes;
    out.curves.push_back(std::move(curve));
  }
}

void add_residuals(FigureSource& out, const MapReader& fit) {
  for (const MapReader& channel : fit.maps("channels")) {
    NoiseFit read;
    read_fields(fit_residual_fields(), channel, read);
    if (read.residuals.empty()) continue;
    SourceResiduals one;
    one.channel = channel.text_or("name", "");
    for (const FitResidual& residual : read.residuals) {
      one.x.push_back(residual.frequency_hz);
      one.z.push_back(residual.z);
      one.outside.push_back(!residual.inside);
    }
    out.residuals.push_back(std::move(one));
  }
}

namespace {

void add_marks(SourceCurve& curve, const MapReader& channel, const NoiseFit& fit) {
  if (!channel.has("derived")) return;
  DerivedNumbers derived;
  read_fields(derived_fields(), channel.map("derived"), derived);
  if (derived.plain_from_s > 0) curve.left_out.push_back({0, derived.plain_from_s});
  for (const ReadOff& point : derived.read_off_points)
    if (const auto& value = fit[point.term].value)
      curve.marks.push_back({point.term, point.tau_s, point.deviation, mark_text(point.term, *value, curve.unit)});
}

void add_band(SourceCurve& curve, const FitBand& band) {
  for (const Interval& out : band.left_out_hz) curve.left_out.push_back(out);
  if (!band.whole && band.top_hz > 0) curve.left_out.push_back({band.top_hz, std::numeric_limits<double>::infinity()});
}

}  // namespace

void add_fit_to_curves(FigureSource& out, const MapReader& fit) {
  for (const MapReader& channel : fit.maps("channels")) {
    if (!channel.has("goodness")) continue;
    NoiseFit read;
    read_fields(noise_fit_fields(), channel, read);
    for (SourceCurve& curve : out.curves) {
      if (curve.channel != channel.text_or("name", "")) continue;
      if (curve.is_allan)
        add_marks(curve, channel, read);
      else
        add_band(curve, read.band);
    }
  }
}

void add_traces(FigureSource& out, const MapReader& trace) {
  const double rate_hz = trace.number_or("rate_hz", 1);
  for (const MapReader& channel : trace.maps("channels")) {
    TraceOfChannel read;
    read_fields(trace_fields(), channel, read);
    channel.list("high", read.trace.low.size());
    if (read.trace.low.empty()) continue;
    SourceTrace one;
    one.channel = read.name;
    one.unit = usual_figure_unit(read.unit);
    const double own_hz = read.own_rate_hz > 0 ? read.own_rate_hz : rate_hz;
    one.block_s = static_cast<double>(read.trace.block) / (own_hz > 0 ? own_hz : 1);
    one.low = read.trace.low;
    one.high = read.trace.high;
    one.marks = read.marks;
    out.traces.push_back(std::move(one));
  }
}

void add_simulated(FigureSource& out, const MapReader& verification) {
  for (const Document& node : verification.list("channels")) {
    if (node.kind != Document::Kind::map) continue;
    VerificationOfChannel simulated;
    read_fields(verification_fields(), MapReader(node, verification.file(), "verification.channels"), simulated);
    for (SourceCurve& curve : out.curves) {
      if (curve.channel != simulated.name) continue;
      if (!curve.is_allan) {
        curve.simulated_x = simulated.spectrum.spectrum.frequency_hz;
        curve.simulated_y = simulated.spectrum.spectrum.value;
        continue;
      }
      for (const AllanPoint& p : simulated.allan.curve.points) {
        curve.simulated_x.push_back(p.tau_s);
        curve.simulated_y.push_back(p.deviation);
      }
    }
  }
}

void add_table(FigureSource& out, const std::string& file, bool is_allan) {
  const auto table = read_curve_table(file, is_allan);
  if (!table) return;
  for (const NamedCurve& named : table->curves) {
    SourceCurve curve;
    curve.channel = named.name;
    curve.unit = usual_figure_unit(named.unit);
    curve.is_allan = is_allan;
    curve.statistic = is_allan ? statistic_of(named.kind) : line_statistic(named.kind);
    curve.value_unit = is_allan                   ? curve.unit
                       : named.value_unit.empty() ? spectrum_unit(Scaling::psd, curve.unit == "U" ? "" : curve.unit)
                                                  : named.value_unit;
    curve.x = named.curve.x;
    curve.y = named.curve.y;
    // A deviation is drawn; a table of variances holds its square.
    if (is_allan && !named.curve.root)
      for (double& y : curve.y) y = std::sqrt(y);
    curve.low68 = named.low68;
    curve.high68 = named.high68;
    curve.low95 = named.low95;
    curve.high95 = named.high95;
    curve.model = named.model;
    out.curves.push_back(std::move(curve));
    detail::add_cautions(out.findings, named.findings, named.name);
  }
}

SourceCurve source_curve(const std::string& channel, const std::string& unit, const AllanCurve& curve) {
  SourceCurve out;
  out.channel = channel;
  out.unit = usual_figure_unit(unit);
  out.value_unit = usual_figure_unit(deviation_unit(curve.type, unit));
  out.statistic = statistic_of(curve.type);
  for (const AllanPoint& p : curve.points) {
    const bool known = p.edf > 0;
    out.x.push_back(p.tau_s);
    out.y.push_back(p.deviation);
    out.low68.push_back(known ? p.ci68.low : kNone);
    out.high68.push_back(known ? p.ci68.high : kNone);
    out.low95.push_back(known ? p.ci95.low : kNone);
    out.high95.push_back(known ? p.ci95.high : kNone);
    out.unreliable.push_back(!p.reliable);
  }
  return out;
}

SourceCurve source_curve(const std::string& channel, const std::string& unit, const Spectrum& spectrum) {
  SourceCurve out;
  out.channel = channel;
  out.unit = usual_figure_unit(unit);
  out.is_allan = false;
  out.statistic = spectrum_statistic(spectrum.sides, spectrum.scaling);
  out.value_unit = spectrum_unit(spectrum.scaling, unit);
  const auto intervals = spectrum_intervals(spectrum, 0.95);
  for (std::size_t i = 0; i < spectrum.frequency_hz.size(); ++i) {
    if (!(spectrum.frequency_hz[i] > 0)) continue;
    out.x.push_back(spectrum.frequency_hz[i]);
    out.y.push_back(spectrum.value[i]);
    out.low95.push_back(intervals[i] ? intervals[i]->low : kNone);
    out.high95.push_back(intervals[i] ? intervals[i]->high : kNone);
  }
  return out;
}

// The curves that a sensor model implies: those of a fit with its coefficients.

namespace {

SourceCurve allan_of(const SensorModel& model, const NoiseFit& fit) {
  const AllanCurve curve = detail::sensor_model_curve(model, fit);
  SourceCurve out;
  for (const AllanPoint& point : curve.points) {
    out.x.push_back(point.tau_s);
    out.y.push_back(point.deviation);
    out.low95.push_back(point.ci95.low);
    out.high95.push_back(point.ci95.high);
  }
  out.lines = allan_asymptotes(fit, curve);
  for (const ReadOff& point : read_off_points(fit, curve))
    out.marks.push_back({point.term, point.tau_s, point.deviation,
                         mark_text(point.term, simulated_value(model[point.term]), out.unit)});
  out.statistic = statistic_of(DeviationType::adev);
  return out;
}

SourceCurve spectrum_of(const NoiseFit& fit, double dt_s, double end_s) {
  SourceCurve out;
  Spectrum grid;
  grid.rate_hz = 1 / dt_s;
  grid.frequency_hz = detail::even_on_log(1 / end_s, 0.5 / dt_s);
  for (const double f : grid.frequency_hz) {
    out.x.push_back(f);
    out.y.push_back(model_spectrum(fit, grid, f).value_or(kNone));
  }
  out.lines = spectrum_asymptotes(fit, grid);
  out.is_allan = false;
  out.statistic = spectrum_statistic(grid.sides, grid.scaling);
  return out;
}

}  // namespace

void add_model(FigureSource& out, const SensorModel& model) {
  const NoiseFit fit = detail::sensor_model_fit(model);
  const Interval times = detail::sensor_model_times(model);
  for (SourceCurve curve : {allan_of(model, fit), spectrum_of(fit, times.low, times.high)}) {
    curve.channel = model.channel;
    curve.unit = usual_figure_unit(model.unit);
    curve.value_unit = curve.is_allan ? curve.unit : spectrum_unit(Scaling::psd, model.unit);
    curve.of_model = true;
    for (SourceMark& mark : curve.marks)
      mark.text = mark_text(mark.term, simulated_value(model[mark.term]), curve.unit);
    out.curves.push_back(std::move(curve));
  }
  detail::add_cautions(out.findings, model.findings, model.channel);
}

namespace {

// A clock's flicker phase is in the document as a power law only.
void read_flicker_phase(NoiseFit& fit, const MapReader& channel) {
  NoiseFit one;
  one.rate_hz = fit.rate_hz;
  one.flicker_phase.emplace().value = 1;
  if (channel.has("power_laws"))
    for (const MapReader& law : channel.maps("power_laws"))
      if (law.number_or("alpha", 0) == 1 && law.has("h"))
        fit.flicker_phase.emplace().value = std::sqrt(law.number("h") / *power_laws(one)[1].h.value);
}

}  // namespace

void add_fits(FigureSource& out, const MapReader& fits) {
  for (const MapReader& channel : fits.maps("channels")) {
    if (!channel.has("goodness")) continue;
    NoiseFit fit;
    read_fields(noise_fit_fields(), channel, fit);
    read_flicker_phase(fit, channel);
    const Channel named{.name = channel.text_or("name", ""), .unit = channel.text_or("unit", "")};
    add_model(out, sensor_model_from_curve(named, fit, "fit", {}));
  }
}

}  // namespace libchar
