// curves.csv: one tidy table, a row for each point of each curve.

#include <fmt/format.h>

#include <cmath>

#include "libchar/characterize/model_curve.hpp"
#include "libchar/core/csv_cell.hpp"
#include "libchar/core/text.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/outputs.hpp"
#include "libchar/spectrum/spectrum_interval.hpp"

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
               const ChannelResult& c,
               const std::string& name,
               const std::string& unit) {
  for (const AllanPoint& p : c.allan.points) {
    const bool known = p.edf > 0;
    const auto bound = [&](double value) { return known ? cell(value) : std::string(); };
    out += fmt::format(
        "{},{},{},s,{},{},{},{},{},{},{},{},{}\n",
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
        c.fit ? cell(model_deviation(*c.fit, c.allan.type, static_cast<double>(p.m), c.allan.dt_s))
              : "");
  }
}

struct Factors {
  IntervalFactors in68{0.6827}, in95{0.95};
};

void add_spectrum(std::string& out,
                  const ChannelResult& c,
                  const std::string& name,
                  Factors& factors) {
  const Spectrum& s = c.spectrum;
  const std::string curve = fmt::format("{}_{}_sided", key_of(s.scaling), key_of(s.sides));
  const std::string unit = csv_cell(spectrum_unit(s.scaling, c.channel.unit));
  for (std::size_t i = 0; i < s.frequency_hz.size(); ++i) {
    const double dof = i < s.dof.size() ? s.dof[i] : 0;
    std::pair<double, double> in68{NAN, NAN}, in95{NAN, NAN};
    if (dof > 0) {
      in68 = factors.in68.interval(s, i);
      in95 = factors.in95.interval(s, i);
    }
    out += fmt::format("{},{},{},Hz,{},{},{},{},{},{},{},,{}\n",
                       curve,
                       name,
                       unit,
                       cell(s.frequency_hz[i]),
                       cell(s.value[i]),
                       cell(in68.first),
                       cell(in68.second),
                       cell(in95.first),
                       cell(in95.second),
                       dof > 0 ? cell(dof) : "",
                       c.fit ? cell(model_spectrum(*c.fit, s, s.frequency_hz[i])) : "");
  }
}

}  // namespace

std::string csv_curves(const Characterization& result) {
  std::string out = "curve,channel,unit,x_unit,x,value,low68,high68,low95,high95,dof,terms,model\n";
  Factors factors;
  for (const ChannelResult& c : result.channels) {
    const std::string name = csv_cell(c.channel.name), unit = csv_cell(c.channel.unit);
    add_allan(out, c, name, unit);
    add_spectrum(out, c, name, factors);
  }
  return out;
}

}  // namespace libchar
