// The error profile of NaveGo in makers' units, for imu_si_errors(): arw deg/sqrt(h), vrw m/s/sqrt(h), a first-order
// Gauss-Markov bias by its standard deviation gb_dyn (deg/s), ab_dyn (mg) and correlation time gb_corr, ab_corr (s):
// simulation/noise_b_dyn.m takes the exact step sigma sqrt(1 - exp(-2 dt/T)). An infinite time would turn it into white
// noise. arrw, vrrw stay 0: noise_rrw.m steps by arrw dt, not K sqrt(dt), so that a density there would hold at one
// rate only; a walk goes into gb_dyn with a long correlation time.

#include <fmt/format.h>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

struct NavegoWriter {
  const ExportOptions& options;
  Export& out;

  void line(const std::string& key, const std::array<double, 3>& v, const std::string& comment) {
    out.text += fmt::format("imu.{} = [{} {} {}];  % {}\n", key, export_number(v[0]), export_number(v[1]),
                            export_number(v[2]), comment_text(comment));
  }

  void white(const SensorTriad& triad) {
    const RowOfAxes row = white_of_axes("navego", triad, Absent::zero, options, out.notes);
    line(row.key, row.values, row.comment);
  }

  void bias(const std::string& letter, const SensorTriad& triad, double factor, const char* unit) {
    const BiasOfAxes of = bias_of_axes(triad, options, factor, letter + "b_dyn", out.notes);
    std::array<double, 3> spread{};
    for (std::size_t i = 0; i < 3; ++i) spread[i] = of.model[i]->bias.spread * of.to_unit[i];
    line(letter + "b_sta", spread, fmt::format("{}, turn-on bias; 0 unless stated", unit));
    line(letter + "b_dyn", of.steady_sd, fmt::format("{}; {}", unit, of.origins));
    line(letter + "b_corr", of.correlation_s, "s; finite: with Inf the bias would be white noise");
  }
};

Export write_navego(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  require_axes(*group.gyroscope, only_axis(options));
  require_axes(*group.accelerometer, only_axis(options));
  const double rate = rate_of(*group.gyroscope, out.notes);
  NavegoWriter writer{options, out};
  out.text = commented(head_lines(group, options,
                                  "arw, vrw = 60 white_noise; gb_dyn, ab_dyn, gb_corr, ab_corr: a Gauss-Markov bias; "
                                  "arrw, vrrw 0: the walk is in it"),
                       "% ");
  out.text +=
      "% For imu_si_errors(imu, 1/imu.freq). The filter takes the bias's driving density as gb_dyn sqrt(gb_corr); of "
      "these\n"
      "% processes it is gb_dyn sqrt(2/gb_corr): set imu_si.gb_psd, imu_si.ab_psd to that after the conversion.\n";
  writer.white(*group.gyroscope);
  writer.white(*group.accelerometer);
  writer.line("arrw", {0, 0, 0}, "see above");
  writer.line("vrrw", {0, 0, 0}, "see above");
  writer.bias("g", *group.gyroscope, kDegreesPerRadian, "deg/s");
  writer.bias("a", *group.accelerometer, 1e3 / 9.80665, "mg");
  out.text += fmt::format("imu.freq = {};  % Hz\n", export_number(rate));
  return out;
}

}  // namespace

ExportTarget navego_target() {
  return {
      "navego",
      "NaveGo",
      "deg/sqrt(h), m/s/sqrt(h); a Gauss-Markov bias by its standard deviation in deg/s, mg and correlation time in s",
      "imu_profile.m",
      ExportNeeds::gyroscope_and_accelerometer,
      "NBK",
      {.gauss_markov = true},
      write_navego};
}

}  // namespace libchar
