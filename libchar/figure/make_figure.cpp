#include "libchar/figure/make_figure.hpp"

#include <map>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/units.hpp"
#include "libchar/figure/detail/figure_parts.hpp"

namespace libchar {
namespace {

constexpr FigureKind kKinds[] = {
    {"allan", "Allan deviation: interval, model, terms, coefficients", false, allan_figure},
    {"psd", "spectrum: interval, model, terms", false, psd_figure},
    {"residuals", "residuals of the fit, in standard deviations", false, residuals_figure},
    {"trace", "the record, and what was found in it", false, trace_figure},
    {"front", "error against run time, and who is beaten in neither", true, front_figure},
    {"memory", "error against memory", true, memory_figure},
    {"ranking", "error of each method with its interval", true, ranking_figure},
    {"timeline", "reference, estimate and best sensor over the run", true, timeline_figure},
    {"error", "error of the estimate and of the best sensor over the run", true, error_figure},
    {"window", "error in a moving window, one line per method", true, window_figure},
    {"weights", "weights over the run, one line per sensor", true, weights_figure, true},
    {"variances", "noise variances as estimated, one line per sensor", true, variances_figure, true},
    {"faults", "known faults and findings, one row per sensor", true, faults_figure, true},
    {"error-allan", "Allan deviation of the error, one line per method", true, error_allan_figure},
};

std::string first_kind(std::span<const FigureSource> sources) {
  const FigureSource& first = sources[0];
  if (first.replay) return "front";
  for (const SourceCurve& curve : first.curves)
    if (curve.is_allan) return "allan";
  return !first.curves.empty() ? "psd" : !first.residuals.empty() ? "residuals" : "trace";
}

const FigureKind& kind_of(const std::string& word) {
  for (const FigureKind& kind : kKinds)
    if (kind.word == word) return kind;
  throw usage_error("E0978", "`kind`")
      .says("no such figure")
      .got(word)
      .hint(did_you_mean(nearest(word, figure_words()), "there are " + first_names(figure_words())));
}

void refuse_mixed(std::span<const FigureSource> sources, const FigureKind& kind) {
  for (const FigureSource& source : sources) {
    if (kind.of_replay && !source.replay)
      throw kind_refusal(source, kind.word).says("it is of replays, and this is the report of none");
    if (!kind.of_replay && source.replay)
      throw kind_refusal(source, kind.word)
          .says("this is the report of a replay, which has front, ranking, timeline and others");
  }
  if (kind.of_replay && sources.size() > 1)
    throw usage_error("E0978", sources[1].file)
        .says("a figure of a replay is of one report")
        .hint("sensorchar compare A B compares two replays");
}

void refuse_unused(const FigureOptions& options, const FigureKind& kind) {
  const auto refuse = [&](const char* option, const char* what) {
    throw usage_error("E0978", option)
        .says("the figure {} is of no {}", kind.word, what)
        .hint("leave it out, or choose another `kind`");
  };
  if (!options.algorithm.empty() && !kind.of_algorithm) refuse("`algorithm`", "single algorithm");
  if (!options.input.empty() && !kind.of_replay) refuse("`input`", "replay");
}

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) value *= factor;
}

/// A density and a power go with the square of the unit.
void convert(SourceCurve& curve, const std::string& unit, double factor) {
  const std::string before = curve.unit;
  const double of_value = curve.statistic.goes_squared ? factor * factor : factor;
  for (auto* values : {&curve.y, &curve.low68, &curve.high68, &curve.low95, &curve.high95, &curve.model,
                       &curve.data_sheet, &curve.simulated_y})
    scale(*values, of_value);
  for (Asymptote& line : curve.lines)
    for (double& y : line.y) y *= of_value;
  for (SourceMark& mark : curve.marks) mark.deviation *= of_value;
  curve.unit = unit;
  const std::size_t place = curve.value_unit.find(before);
  if (place != std::string::npos) curve.value_unit.replace(place, before.size(), unit);
}

/// The unit that the first of a quantity has; nothing where its own is not known.
class CommonUnits {
 public:
  /// The unit and the factor to it; nothing: it has it already, or none is known.
  std::optional<std::pair<std::string, double>> of(const std::string& unit) {
    const auto known = find_unit(unit);
    if (!known || known->quantity == Quantity::ratio) return std::nullopt;
    const std::string& common = unit_.try_emplace(known->quantity, unit).first->second;
    if (common == unit) return std::nullopt;
    return std::pair(common, unit_factor(unit, common).value_or(1));
  }

 private:
  std::map<Quantity, std::string> unit_;
};

/// Curves of one quantity share an axis: they are in the unit of the first. A record also has a zero, which must
/// be the same.
void set_common_units(std::vector<FigureSource>& sources) {
  CommonUnits curves, traces;
  for (FigureSource& source : sources) {
    for (SourceCurve& curve : source.curves)
      if (const auto to = curves.of(curve.unit)) convert(curve, to->first, to->second);
    for (SourceTrace& trace : source.traces) {
      const auto to = traces.of(trace.unit);
      const auto factor = to ? Unit::sample_factor(trace.unit, to->first) : std::nullopt;
      if (!factor) continue;
      scale(trace.low, *factor);
      scale(trace.high, *factor);
      trace.unit = to->first;
    }
  }
}

/// Files of one name in several folders are told apart by these.
std::vector<FigureSource> with_names_apart(std::span<const FigureSource> sources) {
  std::vector<FigureSource> out(sources.begin(), sources.end());
  std::vector<std::string> names, files;
  for (const FigureSource& one : out) {
    names.push_back(one.name);
    files.push_back(one.file);
  }
  detail::set_names_apart(names, files);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].name = names[i];
  return out;
}

}  // namespace

std::span<const FigureKind> figure_kinds() { return kKinds; }

std::vector<std::string> figure_words() {
  std::vector<std::string> out;
  for (const FigureKind& kind : kKinds) out.emplace_back(kind.word);
  return out;
}

Chart make_figure(std::span<const FigureSource> sources, const FigureOptions& options) {
  if (sources.empty()) throw usage_error("E0205", "plot").says("FILE is required");
  if (options.labels.size() > sources.size())
    throw usage_error("E0979", "`labels`")
        .says("{} labels for {} files", options.labels.size(), sources.size())
        .hint("one per file, in their order");
  const FigureKind& kind = kind_of(options.kind.empty() ? first_kind(sources) : options.kind);
  refuse_mixed(sources, kind);
  refuse_unused(options, kind);
  std::vector<FigureSource> drawn = with_names_apart(sources);
  set_common_units(drawn);
  Chart out = kind.make(drawn, options);
  for (const auto* axis : {&out.x, &out.y})
    if (axis->log && !(axis->low > 0))
      throw usage_error("E0981", axis == &out.x ? "`x_range`" : "`y_range`")
          .says("this axis is logarithmic: its range begins above zero");
  out.kind = kind.word;
  out.title = options.title;
  if (!options.title.empty()) out.about = options.title;
  return out;
}

namespace {

// More bands than these hide each other.
constexpr std::size_t kMostCandidateBands = 5;

FigureSeries candidate_series(const ComparedGroup::Candidate& candidate, std::size_t k, bool with_band) {
  FigureSeries out;
  out.name = out.tip = candidate.name + (candidate.takes_part ? "" : " (left out)");
  out.look = series_look(k);
  out.look.size = 1.3;
  if (!candidate.measured) out.look.marker = FigureMarker::none;
  for (const AllanPoint& point : candidate.curve) {
    out.x.push_back(point.tau_s);
    out.y.push_back(point.deviation);
    if (!with_band) continue;
    const bool known = point.ci95.high > 0;
    out.low.push_back(known ? point.ci95.low : kNone);
    out.high.push_back(known ? point.ci95.high : kNone);
  }
  return out;
}

}  // namespace

Chart detail::compared_chart(const ComparedGroup& group) {
  Chart out;
  Extent x(true), y(true), ends(true);
  for (std::size_t k = 0; k < group.candidates.size(); ++k) {
    if (group.candidates[k].curve.empty()) continue;
    FigureSeries series = candidate_series(group.candidates[k], k, group.candidates.size() <= kMostCandidateBands);
    x.take(series.x);
    y.take(series.y);
    out.series.push_back(std::move(series));
  }
  if (out.series.empty()) return out;
  for (const FigureSeries& series : out.series)
    for (const auto* band : {&series.low, &series.high})
      for (const double v : *band) ends.take_near(v, y, 2);
  for (const double v : {ends.low(), ends.high()}) y.take(v);
  if (!out.series.back().low.empty()) out.series.back().band = "95 % interval";
  if (!group.limit_tau_s.empty()) {
    out.series.push_back(
        line_series("data sheet", group.limit_tau_s, group.limit_curve, {.ink = Ink::black, .dash = 3, .width = 1.2}));
    for (const double v : group.limit_curve) y.take_near(v, y, 10);
  }
  x.pad(1.3);
  y.pad(1.4);
  out.kind = "allan";
  out.about = "Allan deviation of " + group.name;
  out.x = {.title = "Averaging time τ [s]", .log = true, .rows = {}};
  out.y = {
      .title = axis_title("Allan deviation, " + group.name, usual_figure_unit(group.unit)), .log = true, .rows = {}};
  set_ends(out.x, x, {});
  set_ends(out.y, y, {});
  return out;
}

}  // namespace libchar
