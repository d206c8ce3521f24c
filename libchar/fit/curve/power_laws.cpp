// One-sided densities of the noise terms (SP 1065, 3.2; two-sided ones in allan/noise_curves.hpp):
//   h_2 = 8 pi² Qz² dt     h_1 = 4 pi F²     h_0 = 2 Q²     h_-1 = B²/pi     h_-2 = K²/(2 pi²)
// Qz, the deviation of a white phase times sqrt(dt), is the quantization term; F that of a flicker phase.
#include "libchar/fit/curve/power_laws.hpp"

#include <algorithm>
#include <array>
#include <numbers>

#include "libchar/allan/noise_type.hpp"

namespace libchar {
namespace {

Coefficient squared(Coefficient c, double factor) {
  const auto h = [factor](double value) { return factor * value * value; };
  if (c.value) c.value = h(*c.value);
  if (c.upper95) c.upper95 = h(*c.upper95);
  c.ci95 = {h(c.ci95.low), h(c.ci95.high)};
  c.relative_sd *= 2;
  if (c.bound) *c.bound *= 2;
  return c;
}

}  // namespace

std::vector<PowerLaw> power_laws(const NoiseFit& fit) {
  using std::numbers::pi;
  if (!fit.flicker_phase || !(fit.rate_hz > 0)) return {};
  const double dt_s = 1 / fit.rate_hz;
  return {
      {2, noise_type_name(2), "WHPM", squared(fit[Term::quantization], 8 * pi * pi * dt_s)},
      {1, noise_type_name(1), "FLPM", squared(*fit.flicker_phase, 4 * pi)},
      {0, noise_type_name(0), "WHFM", squared(fit[Term::white], 2)},
      {-1, noise_type_name(-1), "FLFM", squared(fit[Term::flicker], 1 / pi)},
      {-2, noise_type_name(-2), "RWFM", squared(fit[Term::walk], 1 / (2 * pi * pi))},
  };
}

std::string detail::power_law_unit(int alpha, const std::string& unit) {
  static constexpr std::array<std::string_view, 5> kPowers = {"Hz", "", "Hz⁻¹", "Hz⁻²", "Hz⁻³"};  // of -(alpha + 1)
  const std::string power(kPowers[static_cast<std::size_t>(std::clamp(alpha, -2, 2) + 2)]);
  if (unit.empty() || unit == "1") return power;
  return "(" + unit + ")²" + (power.empty() ? "" : "·" + power);
}

}  // namespace libchar
