// The imunoise block of KF-GINS (i2Nav-WHU): arw deg/sqrt(h), vrw m/s/sqrt(h); biases are first-order Gauss-Markov
// processes of steady standard deviation gbstd (deg/h), abstd (mGal) and one correlation time for all of them, corrtime
// (h): its filter has F = -1/T and the driving density 2 std^2/T (src/kf_gins.cpp, src/kf-gins/gi_engine.cpp). With one
// T for all, a process of another keeps its driving density: std = q sqrt(T/2).

#include <fmt/format.h>

#include "libchar/core/text/decimal.hpp"
#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

constexpr double kMilliGal = 1e5;  // in m/s^2
constexpr double kPartsPerMillion = 1e6;

class KfGinsWriter {
 public:
  KfGinsWriter(const ExportOptions& options, double common_s, Export& out)
      : options_(options), common_s_(common_s), out_(out) {}

  void white(const SensorTriad& triad) {
    const RowOfAxes row = white_of_axes("kf-gins", triad, Absent::limit, options_, out_.notes);
    line(row.key, row.values, row.comment);
  }

  void bias(const std::string& key, const SensorTriad& triad, double factor, const char* unit) {
    std::array<double, 3> values{};
    std::array<std::string, 3> origins;
    for (std::size_t i = 0; i < 3; ++i) {
      const GaussMarkov process = process_of(triad, i);
      values[i] = process.driving * std::sqrt(common_s_ / 2) * factor;
      origins[i] = process.origin;
      if (std::abs(process.correlation_s / common_s_ - 1) > 1e-6 && process.driving > 0)
        origins[i] += fmt::format("; correlation time {} s replaced by corrtime, driving density kept",
                                  shortest(rounded(process.correlation_s, 4)));
      if (process.driving == 0) out_.notes.push_back(fmt::format("{} {}: 0 ({})", key, "xyz"[i], process.origin));
    }
    line(key, values, unit_and_origin(unit, axis_origins(origins)));
  }

  void scale(const std::string& key, const SensorTriad& triad) {
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < 3; ++i) values[i] = placed(triad, i).model->scale_factor.spread * kPartsPerMillion;
    line(key, values, "ppm; not in a recording at rest: 0 unless the model states a spread");
  }

  GaussMarkov process_of(const SensorTriad& triad, std::size_t i) const {
    if (options_.axes != AxisChoice::automatic) return gauss_markov_scalar(triad, options_);
    return gauss_markov(placed(triad, i), options_);
  }

 private:
  const PlacedModel& placed(const SensorTriad& triad, std::size_t i) const {
    return only_axis(options_) ? representative(triad, options_) : *triad.axis[i];
  }

  void line(const std::string& key, const std::array<double, 3>& values, const std::string& comment) {
    out_.text += fmt::format("  {}: {}  # {}\n", key, export_list(values), comment_text(comment));
  }

  const ExportOptions& options_;
  double common_s_;
  Export& out_;
};

Export write_kf_gins(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  require_axes(*group.gyroscope, only_axis(options));
  require_axes(*group.accelerometer, only_axis(options));
  const double common_s = gauss_markov_scalar(*group.gyroscope, options).correlation_s;
  KfGinsWriter writer(options, common_s, out);
  out.text =
      commented(head_lines(group, options,
                           "arw, vrw = 60 white_noise; gbstd, abstd: steady standard deviation of a Gauss-Markov bias; "
                           "corrtime: its correlation time, one for all (that of the gyroscope)"),
                "# ");
  out.text += "imunoise:\n";
  writer.white(*group.gyroscope);
  writer.white(*group.accelerometer);
  writer.bias("gbstd", *group.gyroscope, 3600 * kDegreesPerRadian, "deg/h");
  writer.bias("abstd", *group.accelerometer, kMilliGal, "mGal");
  writer.scale("gsstd", *group.gyroscope);
  writer.scale("asstd", *group.accelerometer);
  out.text += fmt::format("  corrtime: {}  # h\n", export_number(common_s / 3600));
  out.notes.emplace_back(
      "without initbgstd and initbastd KF-GINS starts with gbstd and abstd, which do not hold the turn-on bias: state "
      "those");
  return out;
}

}  // namespace

ExportTarget kf_gins_target() {
  return {"kf-gins",
          "KF-GINS",
          "deg/sqrt(h), m/s/sqrt(h); a Gauss-Markov bias by its steady standard deviation in deg/h, mGal, one "
          "correlation time in h",
          "imunoise.yaml",
          ExportNeeds::gyroscope_and_accelerometer,
          "NBK",
          {.gauss_markov = true},
          write_kf_gins};
}

}  // namespace libchar
