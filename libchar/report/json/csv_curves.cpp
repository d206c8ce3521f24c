// curves.csv: one tidy table, a row for each point of each curve.

#include "libchar/report/json/csv_curves.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/text/csv_cell.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {
namespace {

// An empty cell says "not known"; a spreadsheet makes text of "nan".
std::string cell(double value) {
  return std::isfinite(value) ? shortest(value) : "";
}
std::string cell(const std::optional<double>& value) {
  return value ? cell(*value) : "";
}

void add_allan(std::string& out,
               const ChannelView& view,
               const std::string& name,
               const std::string& unit) {
  const ChannelResult& c = *view.result;
  for (std::size_t i = 0; i < c.allan.points.size(); ++i) {
    const AllanPoint& p = c.allan.points[i];
    const bool known = p.edf > 0;
    const auto bound = [&](double value) { return known ? cell(value) : std::string(); };
    const auto model = view.allan_model ? view.allan_model->intervals[i] : std::nullopt;
    out += fmt::format("{},{},{},s,{},{},{},{},{},{},{},{},{},{},{}\n",
                       name_of(c.allan.type),
                       name,
                       unit,
                       cell(p.tau_s),
                       cell(p.deviation),
                       bound(p.ci68.low),
                       bound(p.ci68.high),
                       bound(p.ci95.low),
                       bound(p.ci95.high),
                       bound(p.edf),
                       p.terms,
                       view.allan_model ? cell(view.allan_model->values[i]) : "",
                       model ? cell(model->low) : "",
                       model ? cell(model->high) : "");
  }
}

void add_spectrum(std::string& out, const ChannelView& view, const std::string& name) {
  const ChannelResult& c = *view.result;
  const Spectrum& s = c.spectrum;
  const auto low = [](const std::optional<Interval>& i) { return i ? cell(i->low) : ""; };
  const auto high = [](const std::optional<Interval>& i) { return i ? cell(i->high) : ""; };
  const std::string curve = fmt::format("{}_{}_sided", name_of(s.scaling), name_of(s.sides));
  const std::string unit = csv_cell(spectrum_unit(s.scaling, c.channel.unit));
  for (std::size_t i = 0; i < s.frequency_hz.size(); ++i) {
    const double dof = i < s.dof.size() ? s.dof[i] : 0;
    out += fmt::format("{},{},{},Hz,{},{},{},{},{},{},{},,{},,\n",
                       curve,
                       name,
                       unit,
                       cell(s.frequency_hz[i]),
                       cell(s.value[i]),
                       low(view.spectrum_ci68[i]),
                       high(view.spectrum_ci68[i]),
                       low(view.spectrum_ci95[i]),
                       high(view.spectrum_ci95[i]),
                       dof > 0 ? cell(dof) : "",
                       view.spectrum_model ? cell(view.spectrum_model->values[i]) : "");
  }
}

}  // namespace

std::string csv_curves(const CharacterizationView& view) {
  std::string out =
      "curve,channel,unit,x_unit,x,value,low68,high68,low95,high95,dof,terms,model,model_low95,"
      "model_high95\n";
  for (const ChannelView& channel : view.channels) {
    const Channel& of = channel.result->channel;
    const std::string name = csv_cell(of.name), unit = csv_cell(of.unit);
    add_allan(out, channel, name, unit);
    add_spectrum(out, channel, name);
  }
  return out;
}

std::string csv_curves(const Characterization& result) {
  return csv_curves(characterization_view(result));
}

}  // namespace libchar
