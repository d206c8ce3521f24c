// curves.csv: one tidy table, a row for each point of each curve.

#include "libchar/report/json/csv_curves.hpp"

#include <fmt/format.h>

#include "libchar/core/not_known.hpp"
#include "libchar/core/text/csv_cell.hpp"

namespace libchar {
namespace {

Interval or_none(const std::optional<Interval>& interval) {
  return interval.value_or(Interval{kNone, kNone});
}

void add_allan(std::string& out, const ChannelView& view) {
  const ChannelResult& c = *view.result;
  for (std::size_t i = 0; i < c.allan.points.size(); ++i) {
    const AllanPoint& p = c.allan.points[i];
    const auto known = [&](double value) { return p.edf > 0 ? value : kNone; };
    const Interval model = view.allan_model ? or_none(view.allan_model->intervals[i]) : or_none({});
    out += csv_line(name_of(c.allan.type),
                    c.channel.name,
                    c.channel.unit,
                    "s",
                    p.tau_s,
                    p.deviation,
                    known(p.ci68.low),
                    known(p.ci68.high),
                    known(p.ci95.low),
                    known(p.ci95.high),
                    known(p.edf),
                    p.terms,
                    view.allan_model ? view.allan_model->values[i] : std::nullopt,
                    model.low,
                    model.high);
  }
}

void add_spectrum(std::string& out, const ChannelView& view) {
  const ChannelResult& c = *view.result;
  const Spectrum& s = c.spectrum;
  const std::string curve = fmt::format("{}_{}_sided", name_of(s.scaling), name_of(s.sides));
  const std::string unit = spectrum_unit(s.scaling, c.channel.unit);
  for (std::size_t i = 0; i < s.frequency_hz.size(); ++i) {
    const Interval ci68 = or_none(view.spectrum_ci68[i]), ci95 = or_none(view.spectrum_ci95[i]);
    out += csv_line(curve,
                    c.channel.name,
                    unit,
                    "Hz",
                    s.frequency_hz[i],
                    s.value[i],
                    ci68.low,
                    ci68.high,
                    ci95.low,
                    ci95.high,
                    i < s.dof.size() && s.dof[i] > 0 ? s.dof[i] : kNone,
                    "",
                    view.spectrum_model ? view.spectrum_model->values[i] : std::nullopt,
                    "",
                    "");
  }
}

}  // namespace

std::string csv_curves(const CharacterizationView& view) {
  std::string out =
      "curve,channel,unit,x_unit,x,value,low68,high68,low95,high95,dof,terms,model,model_low95,"
      "model_high95\n";
  for (const ChannelView& channel : view.channels) {
    add_allan(out, channel);
    add_spectrum(out, channel);
  }
  return out;
}

std::string csv_curves(const Characterization& result) {
  return csv_curves(characterization_view(result));
}

}  // namespace libchar
