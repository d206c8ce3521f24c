// Our fit against the estimators of imu_utils and allan_variance_ros, and a relative least squares as in nmayorov's
// script, on the same simulated records; and against the published fits of imu_utils on its own curves of six real
// IMUs. Usage: peers_bench [records a scene = 12] [scene numbers = all]
// The estimators are those of `sensorchar bench` (libchar/benchmark/detail/peer_estimators.cpp).

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/curve/curve_fit.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "tests/support/curves.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/places.hpp"

namespace {

using namespace libchar;
using test::numbers;
using test::rms_log10;
using Clock = std::chrono::steady_clock;
using Values = std::array<double, 3>;  // Q, B, K; 0 = absent

struct Scene {
  std::string name;
  double rate_hz;
  std::size_t samples;
  Values truth;
};

const std::vector<Scene> kScenes = {
    {"Q", 100, 1080000, {2.5e-3, 0, 0}},           {"Q K", 100, 1080000, {2.502e-3, 0, 6.97e-5}},
    {"Q B K", 100, 1080000, {2.5e-3, 6e-4, 7e-6}}, {"fixture gyro_z", 50, 50000, {4e-3, 4e-3, 1.5e-3}},
    {"fixture accel_z", 50, 50000, {1e-4, 0, 0}},
};

Values of(const NoiseEstimate& estimate) {
  return {estimate[0].value.value_or(0), estimate[1].value.value_or(0), estimate[2].value.value_or(0)};
}

Values imu_utils_values(const std::vector<double>& y, double rate_hz) { return of(imu_utils(y, rate_hz, {})); }

Values allan_variance_ros_values(const std::vector<double>& y, double rate_hz) {
  return of(allan_variance_ros(y, rate_hz, {}));
}

Values relative_values(const std::vector<double>& y, double rate_hz) {
  return of(relative_least_squares(y, rate_hz, {}));
}

Values ours(const std::vector<double>& y, double rate_hz) {
  const AllanCurve curve = allan_deviation(y, 1 / rate_hz);
  const NoiseFit fit = fit_record(y, rate_hz, &curve);
  return {fit[Term::white].value.value_or(0), fit[Term::flicker].value.value_or(0), fit[Term::walk].value.value_or(0)};
}

// ---- the comparison ----

struct Method {
  std::string name;
  Values (*estimate)(const std::vector<double>&, double);
};

const std::vector<Method> kMethods = {{"sensorchar", ours},
                                      {"imu_utils", imu_utils_values},
                                      {"allan_variance_ros", allan_variance_ros_values},
                                      {"relative NNLS", relative_values}};

struct Tally {
  Values sum{}, error{};  // error: sum of squares about the truth
  double seconds = 0;
};

std::string cell(const Tally& t, std::size_t k, int n, double truth, double reference) {
  const double rms = std::sqrt(t.error[k] / n), mean = t.sum[k] / n;
  const std::string ratio = reference > 0 ? fmt::format("{:.3g} ×", rms / reference) : rms > 0 ? "–" : "0";
  return truth > 0 ? fmt::format("{:.4g} ± {:.2g} ({})", mean, rms, ratio) : fmt::format("{:.2g} (absent)", mean);
}

void run_scene(const Scene& scene, std::uint64_t seed, int records) {
  std::vector<Tally> tallies(kMethods.size());
  test::NoiseSource source(scene.samples, scene.rate_hz, seed);
  for (int i = 0; i < records; ++i) {
    const std::vector<double> y = source.record(scene.truth[0], scene.truth[1], scene.truth[2]);
    for (std::size_t k = 0; k < kMethods.size(); ++k) {
      const auto from = Clock::now();
      const Values got = kMethods[k].estimate(y, scene.rate_hz);
      tallies[k].seconds += std::chrono::duration<double>(Clock::now() - from).count();
      for (std::size_t t = 0; t < 3; ++t) {
        tallies[k].sum[t] += got[t];
        tallies[k].error[t] += (got[t] - scene.truth[t]) * (got[t] - scene.truth[t]);
      }
    }
  }
  fmt::print("\n{}: Q {:g}, B {:g}, K {:g}; {} samples at {:g} Hz, {} records\n\n", scene.name, scene.truth[0],
             scene.truth[1], scene.truth[2], scene.samples, scene.rate_hz, records);
  fmt::print("| method | Q | B | K | ms |\n|---|---|---|---|---|\n");
  for (std::size_t k = 0; k < kMethods.size(); ++k) {
    fmt::print("| {} |", kMethods[k].name);
    for (std::size_t t = 0; t < 3; ++t)
      fmt::print(" {} |", cell(tallies[k], t, records, scene.truth[t], std::sqrt(tallies[0].error[t] / records)));
    fmt::print(" {:.0f} |\n", 1e3 * tallies[k].seconds / records);
  }
}

// ---- published curves ----

void run_curves(const std::filesystem::path& folder) {
  fmt::print(
      "\nrms of log10(model/measured deviation) on the curves that imu_utils published, mean of three axes:\n\n");
  fmt::print(
      "| IMU | sensor | imu_utils | ours, all terms | ours, decided | worst axis, decided ÷ imu_utils "
      "|\n|---|---|---|---|---|---|\n");
  for (const std::string imu : {"16448", "A3", "BMI160", "N3", "gx4", "xsens"})
    for (const std::string kind : {"acc", "gyr"}) {
      double theirs = 0, all_terms = 0, decided = 0, worst = 0;
      for (const std::string axis : {"x", "y", "z"}) {
        DigitisedCurve curve;
        curve.x = numbers(folder / ("data_" + imu + "_" + kind + "_t.txt"));
        curve.y = numbers(folder / ("data_" + imu + "_" + kind + "_" + axis + ".txt"));
        FitOptions all;
        all.threshold = 0;
        const double t = rms_log10(curve.y, numbers(folder / ("data_" + imu + "_sim_" + kind + "_" + axis + ".txt")));
        const double d = rms_log10(fit_curve(curve));
        theirs += t / 3;
        all_terms += rms_log10(fit_curve(curve, all)) / 3;
        decided += d / 3;
        worst = std::max(worst, d / t);
      }
      fmt::print("| {} | {} | {:.4f} | {:.4f} | {:.4f} | {:.3f} |\n", imu, kind, theirs, all_terms, decided, worst);
    }
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 12;
  const std::string wanted = argc > 2 ? argv[2] : "";
  for (std::size_t s = 0; s < kScenes.size(); ++s)
    if (wanted.empty() || wanted.find(static_cast<char>('0' + s)) != std::string::npos)
      run_scene(kScenes[s], 20 + s, records);
  const std::filesystem::path curves = test::shared_folder() / "oracle/allan/imu_utils_mit";
  if (std::filesystem::exists(curves))
    run_curves(curves);
  else
    fmt::print("\nthe curves of imu_utils are not beside this checkout: skipped\n");
}
