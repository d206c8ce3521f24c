#include "libchar/figure/detail/curve_sources.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/characterize/model_curve.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/units.hpp"
#include "libchar/figure/detail/report_values.hpp"
#include "libchar/fit/curve_table.hpp"
#include "libchar/log/text_table.hpp"
#include "libchar/spectrum/spectrum_interval.hpp"

namespace libchar {
namespace {

std::string statistic_of(const std::string& word) {
  const auto type = deviation_type(word);
  return type ? std::string(deviation_row(*type).title) : word.empty() ? "Allan deviation" : word;
}

std::optional<Term> term_of(std::string_view key) {
  for (std::size_t t = 0; t < kTerms; ++t)
    if (kTermNames[t].key == key) return static_cast<Term>(t);
  return std::nullopt;
}

std::vector<SourceLine> lines_of(const MapReader& channel) {
  std::vector<SourceLine> out;
  if (!channel.has("asymptotes")) return out;
  const MapReader lines = open_report(channel, "asymptotes");
  for (const DocumentEntry& entry : lines.node().map) {
    const auto term = term_of(entry.key);
    if (!term || entry.value.kind != Document::Kind::list || entry.value.list.size() != 2) continue;
    SourceLine line{*term, {}, {}};
    for (std::size_t i = 0; i < 2; ++i) {
      const auto point = report_numbers(lines, entry.key, entry.value.list[i], 2);
      line.x[i] = point[0];
      line.y[i] = point[1];
    }
    out.push_back(line);
  }
  return out;
}

void read_named(SourceCurve& out, const MapReader& channel) {
  out.channel = channel.text_or("name", "");
  out.unit = usual_figure_unit(channel.text_or("unit", ""));
}

std::string line_statistic(const std::string& kind) {
  // "psd_one_sided" of curves.csv
  for (const Sides sides : {Sides::one, Sides::two})
    for (const EnumWord<Scaling>& row : enum_table<Scaling>)
      if (kind == fmt::format("{}_{}_sided", row.word, name_of(sides)))
        return spectrum_statistic(sides, row.value);
  return kind.empty() ? "Power spectral density" : kind;
}

}  // namespace

std::string spectrum_statistic(Sides sides, Scaling scaling) {
  std::string word(name_of(scaling));
  std::transform(word.begin(), word.end(), word.begin(), [](char c) {
    return static_cast<char>(c - 'a' + 'A');
  });
  return (sides == Sides::one ? "One-sided " : "Two-sided ") + word;
}

std::string mark_text(Term term, double value, const std::string& unit) {
  const auto& name = kTermNames[static_cast<std::size_t>(term)];
  const std::string shown = shown_term_unit(name.key, unit == "U" ? "" : unit);
  return fmt::format(
      "{} = {}{}", name.letter, number_text(value, 3), shown.empty() ? "" : " " + shown);
}

void add_allan_curves(FigureSource& out, const MapReader& document) {
  const std::string type = document.text_or("type", "");
  for (const MapReader& channel : open_reports(document, "channels")) {
    SourceCurve curve;
    read_named(curve, channel);
    curve.statistic = statistic_of(channel.text_or("type", type));
    curve.value_unit = channel.has("value_unit")
                           ? usual_figure_unit(channel.text_or("value_unit", ""))
                           : curve.unit;
    curve.x = report_numbers(channel, "tau_s");
    const std::size_t n = curve.x.size();
    if (n == 0) continue;
    curve.y = report_numbers(channel, "deviation", channel.require("deviation"), n);
    ReportIntervals in68 = report_intervals(channel, "ci68", n),
                    in95 = report_intervals(channel, "ci95", n);
    curve.low68 = std::move(in68.low);
    curve.high68 = std::move(in68.high);
    curve.low95 = std::move(in95.low);
    curve.high95 = std::move(in95.high);
    curve.model = report_numbers(channel, "model", n);
    curve.data_sheet = report_numbers(channel, "data_sheet", n);
    curve.unreliable = report_flags(channel, "reliable", n);
    curve.unreliable.flip();
    curve.lines = lines_of(channel);
    out.curves.push_back(std::move(curve));
  }
}

void add_spectra(FigureSource& out, const MapReader& document) {
  const std::string sides = document.text_or("sides", "one"),
                    scaling = document.text_or("scaling", "psd");
  for (const MapReader& channel : open_reports(document, "channels")) {
    SourceCurve curve;
    read_named(curve, channel);
    curve.is_allan = false;
    const auto side = find_enum<Sides>(sides);
    const auto scale = find_enum<Scaling>(scaling);
    curve.statistic = side && scale ? spectrum_statistic(*side, *scale) : sides + " " + scaling;
    curve.value_unit =
        channel.text_or("value_unit", spectrum_unit(scale.value_or(Scaling::psd), curve.unit));
    curve.x = report_numbers(channel, "frequency_hz");
    const std::size_t n = curve.x.size();
    if (n == 0) continue;
    curve.y = report_numbers(channel, "value", channel.require("value"), n);
    ReportIntervals in95 = report_intervals(channel, "ci95", n);
    curve.low95 = std::move(in95.low);
    curve.high95 = std::move(in95.high);
    curve.model = report_numbers(channel, "model", n);
    curve.lines = lines_of(channel);
    out.curves.push_back(std::move(curve));
  }
}

void add_residuals(FigureSource& out, const MapReader& fit) {
  for (const MapReader& channel : open_reports(fit, "channels")) {
    if (!channel.has("residuals")) continue;
    const MapReader residuals = open_report(channel, "residuals");
    SourceResiduals one;
    one.channel = channel.text_or("name", "");
    one.over_tau = channel.flag_or("of_curve", false);
    one.x = report_numbers(residuals, "frequency_hz");
    one.z = report_numbers(residuals, "z", one.x.size());
    one.outside = report_flags(residuals, "inside", one.x.size());
    one.outside.flip();
    if (!one.x.empty() && !one.z.empty()) out.residuals.push_back(std::move(one));
  }
}

namespace {

void add_marks(SourceCurve& curve, const MapReader& channel) {
  if (!channel.has("derived")) return;
  const MapReader derived = open_report(channel, "derived");
  if (const double plain = derived.number_or("plain_from_s", 0); plain > 0)
    curve.left_out.push_back({0, plain});
  if (!derived.has("read_off_points")) return;
  for (const MapReader& point : open_reports(derived, "read_off_points")) {
    const auto term = term_of(point.text_or("term", ""));
    if (!term || !channel.has(kTermNames[static_cast<std::size_t>(*term)].key)) continue;
    const MapReader coefficient =
        open_report(channel, kTermNames[static_cast<std::size_t>(*term)].key);
    const auto value = coefficient.maybe_number("value");
    if (!value) continue;
    curve.marks.push_back({*term,
                           point.number("tau_s"),
                           point.number("deviation"),
                           mark_text(*term, *value, curve.unit)});
  }
}

void add_band(SourceCurve& curve, const MapReader& channel) {
  if (!channel.has("band")) return;
  const MapReader band = open_report(channel, "band");
  const ReportIntervals out = report_intervals(band, "left_out_hz", 0);
  for (std::size_t i = 0; i < out.low.size(); ++i)
    curve.left_out.push_back({out.low[i], out.high[i]});
  const double top = band.number_or("top_hz", 0);
  if (!band.flag_or("whole", true) && top > 0)
    curve.left_out.push_back({top, std::numeric_limits<double>::infinity()});
}

}  // namespace

void add_fit_to_curves(FigureSource& out, const MapReader& fit) {
  for (const MapReader& channel : open_reports(fit, "channels"))
    for (SourceCurve& curve : out.curves)
      if (curve.channel == channel.text_or("name", "")) {
        if (curve.is_allan)
          add_marks(curve, channel);
        else
          add_band(curve, channel);
      }
}

void add_traces(FigureSource& out, const MapReader& trace) {
  const double rate_hz = trace.number_or("rate_hz", 1);
  for (const MapReader& channel : open_reports(trace, "channels")) {
    SourceTrace one;
    one.channel = channel.text_or("name", "");
    one.unit = usual_figure_unit(channel.text_or("unit", ""));
    one.block_s =
        channel.number_or("samples_per_block", 1, kPositive) / (rate_hz > 0 ? rate_hz : 1);
    one.low = report_numbers(channel, "low");
    one.high = report_numbers(channel, "high", one.low.size());
    if (channel.has("marks"))
      for (const MapReader& mark : open_reports(channel, "marks"))
        one.marks.push_back(
            {mark.text_or("label", ""), mark.number("from_s"), mark.number("to_s")});
    if (!one.low.empty() && !one.high.empty()) out.traces.push_back(std::move(one));
  }
}

void add_simulated(FigureSource& out, const MapReader& verification) {
  for (const Document& node : verification.list("channels")) {
    if (node.kind != Document::Kind::map) continue;
    const MapReader channel = open_report(node, verification.file(), "verification.channels");
    for (SourceCurve& curve : out.curves) {
      if (curve.channel != channel.text_or("name", "")) continue;
      const char* part = curve.is_allan ? "allan" : "spectrum";
      if (!channel.has(part)) continue;
      const MapReader simulated = open_report(channel, part);
      curve.simulated_x = report_numbers(simulated, curve.is_allan ? "tau_s" : "frequency_hz");
      curve.simulated_y = report_numbers(
          simulated, curve.is_allan ? "deviation" : "value", curve.simulated_x.size());
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
    curve.value_unit = is_allan ? curve.unit
                       : named.value_unit.empty()
                           ? spectrum_unit(Scaling::psd, curve.unit == "U" ? "" : curve.unit)
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
  }
}

namespace {

struct WideColumn {
  std::string name, unit;
};

std::optional<WideColumn> wide_column(const std::string& cell) {
  const std::size_t open = cell.rfind('[');
  if (open == std::string::npos || !cell.ends_with(']')) return std::nullopt;
  return WideColumn{cell.substr(0, open), cell.substr(open + 1, cell.size() - open - 2)};
}

// "(deg/s)²/Hz": what it is and of what, as spectrum_unit writes it.
std::pair<std::string, std::string> density_of(const std::string& unit) {
  for (const auto& [end, statistic] : {std::pair{"²/Hz", "PSD"}, {"/√Hz", "LSD"}, {"²", "PS"}}) {
    if (!unit.ends_with(end)) continue;
    std::string base = unit.substr(0, unit.size() - std::string_view(end).size());
    if (base.starts_with('(') && base.ends_with(')')) base = base.substr(1, base.size() - 2);
    return {statistic, base};
  }
  return {"LS", unit};
}

}  // namespace

void add_wide_spectra(FigureSource& out, const std::string& file) {
  const auto table = read_text_table(file, kMaxDocumentBytes);
  if (!table || table->header.cells.size() < 2 || table->header.cells[0].text != "frequency_hz")
    return;
  std::vector<SourceCurve> curves;
  for (std::size_t c = 1; c < table->header.cells.size(); ++c) {
    const auto column = wide_column(table->header.cells[c].text);
    if (!column) return;
    SourceCurve& curve = curves.emplace_back();
    const auto [statistic, base] = density_of(column->unit);
    curve.channel = column->name;
    curve.unit = usual_figure_unit(base == "U" ? "" : base);
    curve.is_allan = false;
    curve.value_unit = column->unit;
    curve.statistic = statistic;
  }
  bool two_sided = false;
  for (const TextRow& row : table->rows) {
    const auto number = [&](std::size_t c) {
      const auto value =
          c < row.cells.size() ? number_in(row.cells[c], table->decimal) : std::nullopt;
      if (value) return *value;
      throw Error({ErrorKind::input,
                   "E0311",
                   fmt::format("{}:{}", file, row.line),
                   "a number was expected in each column of the header",
                   c < row.cells.size() ? row.cells[c].text : "",
                   ""});
    };
    const double f = number(0);
    two_sided = two_sided || f < 0;
    for (std::size_t c = 0; c < curves.size(); ++c) {
      const double y = number(c + 1);
      if (!(f > 0)) continue;
      curves[c].x.push_back(f);
      curves[c].y.push_back(y);
    }
  }
  for (SourceCurve& curve : curves) {
    curve.statistic = (two_sided ? "Two-sided " : "One-sided ") + curve.statistic;
    out.curves.push_back(std::move(curve));
  }
}

SourceCurve source_curve(const std::string& channel,
                         const std::string& unit,
                         const AllanCurve& curve) {
  SourceCurve out;
  out.channel = channel;
  out.unit = usual_figure_unit(unit);
  out.value_unit = usual_figure_unit(deviation_unit(curve.type, unit));
  out.statistic = deviation_row(curve.type).title;
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

SourceCurve source_curve(const std::string& channel,
                         const std::string& unit,
                         const Spectrum& spectrum) {
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

}  // namespace libchar
