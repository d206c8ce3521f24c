// Learning algorithms of fusion: what they cost and what they reach.
//   fusion_learning_bench perceptron [SEEDS]  training time and RMS, 3 to 30 neurons, five sensors
//                                             of [RV] 3.3 (calibrated)
//   fusion_learning_bench takens              microseconds a step; RMS against the optimum
//   fusion_learning_bench tilt                RMS of the tilt filters against the best-tuned ones

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstring>
#include <ctime>
#include <vector>

#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/tilt_angle.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

using Values = std::vector<std::pair<std::string_view, double>>;

std::unique_ptr<Runner> make(const char* name, const Array& array, const Values& values = {}) {
  Settings settings(algorithm(name).options);
  for (const auto& [option, value] : values) settings.set(option, value);
  return algorithm(name).make(array, settings);
}

double seconds_since(std::chrono::steady_clock::time_point from) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - from).count();
}

struct Scene {
  Eigen::MatrixXd y;
  Eigen::VectorXd x;
  Array array;
};

/// White levels of [RV] table 3.1 (variance 608.4 S and 14.5 S of flicker, taken as
/// white here); the input has variance 5.78 and, after its filter, correlation .285 at one sample.
Scene five_sensors(std::uint64_t seed, Eigen::Index instants, Eigen::Index learning) {
  const Eigen::ArrayXd variances = 623.0 * (Eigen::ArrayXd(5) << 5e-3, 1e-3, 5e-4, 1e-4, 5e-5).finished();
  test::Gaussian gauss(seed);
  Scene made{Eigen::MatrixXd(5, instants), Eigen::VectorXd(instants), {}};
  constexpr double kCorrelation = 0.285;
  double x = std::sqrt(5.78) * gauss();
  for (Eigen::Index k = 0; k < instants; ++k) {
    x = kCorrelation * x + std::sqrt(5.78 * (1 - kCorrelation * kCorrelation)) * gauss();
    made.x[k] = x;
    for (Eigen::Index i = 0; i < 5; ++i) made.y(i, k) = x + std::sqrt(variances[i]) * gauss();
  }
  made.array.channels = 5;
  made.array.noise_levels = variances.matrix();
  made.array.learning_samples = learning;
  return made;
}

double rms_from(Runner& runner, const Scene& scene, Eigen::Index from) {
  const Eigen::Index count = scene.y.cols() - from;
  Eigen::MatrixXd x(1, count), variance(1, count);
  runner.run(scene.y.rightCols(count), x, variance);
  return std::sqrt((x.row(0).transpose() - scene.x.tail(count)).squaredNorm() / static_cast<double>(count));
}

void perceptron(int seeds) {
  constexpr Eigen::Index kLearning = 10000, kInstants = 100000;
  fmt::print("five sensors, 10 000 instants to learn from, 90 000 judged, {} seeds; optimum .1369\n", seeds);
  fmt::print("{:>8} {:>10} {:>9} {:>8} {:>9} {:>9}\n", "neurons", "CPU s", "RMS", "std", "thesis", "ns/step");
  const std::array<std::pair<int, double>, 5> rows{{{3, .1370}, {5, .1370}, {10, .1373}, {20, .1372}, {30, .1378}}};
  for (const auto& [neurons, thesis] : rows) {
    std::vector<double> rms, took, step;
    for (int seed = 1; seed <= seeds; ++seed) {
      const Scene scene = five_sensors(static_cast<std::uint64_t>(seed), kInstants, kLearning);
      auto runner = make("perceptron", scene.array, {{"neurons", neurons}});
      runner->learn(scene.y.leftCols(kLearning), scene.x.head(kLearning).transpose());
      const std::clock_t begun = std::clock();  // of the processor: others may be at work
      runner->finish_learning();
      took.push_back(static_cast<double>(std::clock() - begun) / CLOCKS_PER_SEC);
      const auto from = std::chrono::steady_clock::now();
      rms.push_back(rms_from(*runner, scene, kLearning));
      step.push_back(1e9 * seconds_since(from) / static_cast<double>(kInstants - kLearning));
    }
    const Eigen::Map<const Eigen::ArrayXd> r(rms.data(), static_cast<Eigen::Index>(rms.size()));
    fmt::print("{:>8} {:>10.2f} {:>9.5f} {:>8.5f} {:>9.4f} {:>9.0f}\n", neurons,
               *std::max_element(took.begin(), took.end()), r.mean(), std::sqrt((r - r.mean()).square().mean()), thesis,
               *std::min_element(step.begin(), step.end()));
  }
}

void takens() {
  const Scene white = five_sensors(1, 30000, 2000);
  Scene slow = white;  // an input that the past tells much about
  for (Eigen::Index k = 0; k < slow.x.size(); ++k) {
    const double x = 3.4 * std::sin(0.15 * static_cast<double>(k));
    slow.y.col(k).array() += x - slow.x[k];
    slow.x[k] = x;
  }
  constexpr Eigen::Index kFrom = 2000;
  fmt::print("{:>26} {:>4} {:>5} {:>9} {:>12} {:>12}\n", "algorithm", "d", "m", "us/step", "RMS white", "RMS sine");
  fmt::print("{:>26} {:>4} {:>5} {:>9} {:>12.5f} {:>12.5f}\n", "inverse-variance", "", "", "",
             rms_from(*make("inverse-variance", white.array), white, kFrom),
             rms_from(*make("inverse-variance", slow.array), slow, kFrom));
  for (const char* name : {"kalman-takens", "kalman-takens-taught", "kalman-takens-published"})
    for (const double d : {3, 6, 12})
      for (const double m : {300, 1000, 5000}) {
        const bool published = !std::strcmp(name, "kalman-takens-published");
        Values values{{"dimension", d}, {published ? "training" : "dictionary", m}};
        std::array<double, 2> rms{};
        double best = 1e300;
        for (std::size_t s = 0; s < 2; ++s) {
          const Scene& scene = s == 0 ? white : slow;
          auto runner = make(name, scene.array, values);
          runner->learn(scene.y.leftCols(kFrom), scene.x.head(kFrom).transpose());
          runner->finish_learning();
          Eigen::MatrixXd x(1, kFrom), variance(1, kFrom);
          for (Eigen::Index k = kFrom; k + kFrom <= scene.y.cols(); k += kFrom) {
            const auto from = std::chrono::steady_clock::now();
            runner->run(scene.y.middleCols(k, kFrom), x, variance);
            if (k > 6000) best = std::min(best, 1e6 * seconds_since(from) / kFrom);
            rms[s] += (x.row(0).transpose() - scene.x.segment(k, kFrom)).squaredNorm();
          }
          rms[s] = std::sqrt(rms[s] / static_cast<double>(scene.y.cols() / kFrom * kFrom - kFrom));
        }
        fmt::print("{:>26} {:>4} {:>5} {:>9.2f} {:>12.5f} {:>12.5f}\n", name, d, m, best, rms[0], rms[1]);
      }
  fmt::print("as published with R the density, after the training (thesis .1363 and .1569, oracle .1369 and .1495):");
  for (const auto& [d, q] : {std::pair{6.0, 1e-2}, std::pair{4.0, 1e-3}}) {
    auto runner = make("kalman-takens-published", white.array,
                       {{"dimension", d}, {"process_variance", q}, {"noise_scale", 1 / 623.0}});
    Eigen::MatrixXd x(1, kFrom), variance(1, kFrom);
    runner->run(white.y.leftCols(kFrom), x, variance);
    fmt::print(" {:.4f}", rms_from(*runner, white, kFrom));
  }
  fmt::print("\n");
}

struct TiltScene {
  Eigen::MatrixXd y;
  Eigen::VectorXd angle;
  Array array;
};

/// [RV 2.5]: 500 Hz; a swing of +-2.09 rad; rate noise and bias walk of a consumer gyroscope,
/// accelerometers of 0.05 of gravity.
TiltScene tilt_scene(std::uint64_t seed, Eigen::Index instants, double rate_noise, double gravity_noise) {
  test::Gaussian gauss(seed);
  TiltScene made{Eigen::MatrixXd(3, instants), Eigen::VectorXd(instants), {}};
  constexpr double kRate = 500, kSwing = 2.09, kPulse = 1;
  double bias = 0.01;
  for (Eigen::Index k = 0; k < instants; ++k) {
    const double t = static_cast<double>(k) / kRate, angle = kSwing * std::sin(kPulse * t);
    bias += 1e-3 / std::sqrt(kRate) * gauss();
    made.angle[k] = angle;
    made.y(0, k) = kSwing * kPulse * std::cos(kPulse * t) + bias + rate_noise * std::sqrt(kRate) * gauss();
    made.y(1, k) = 9.81 * (std::sin(angle) + gravity_noise * gauss());
    made.y(2, k) = 9.81 * (std::cos(angle) + gravity_noise * gauss());
  }
  made.array.channels = 3;
  made.array.rate_hz = kRate;
  made.array.tilt = TiltChannels{};
  made.array.learning_samples = instants / 4;
  return made;
}

double tilt_rms(Runner& runner, const TiltScene& scene) {
  const Eigen::Index learning = scene.array.learning_samples, count = scene.y.cols() - learning;
  runner.learn(scene.y.leftCols(learning), scene.angle.head(learning).transpose());
  runner.finish_learning();
  Eigen::MatrixXd x(1, count), variance(1, count);
  runner.run(scene.y.rightCols(count), x, variance);
  double sum = 0;
  for (Eigen::Index k = count / 10; k < count; ++k) {
    const double off = wrapped(x(0, k) - scene.angle[learning + k]);
    sum += off * off;
  }
  return std::sqrt(sum / static_cast<double>(count - count / 10));
}

void tilt() {
  const TiltScene scene = tilt_scene(1, 400000, 1e-3, 0.05);
  double best_lambda = 1e300, best_kalman = 1e300, lambda = 0, q = 0, r = 0;
  for (double tau = 0.01; tau < 200; tau *= 1.15)
    if (const double got = tilt_rms(*make("tilt-complementary", scene.array, {{"time_constant", tau}}), scene);
        got < best_lambda) {
      best_lambda = got;
      lambda = tau;
    }
  for (double angle = 1e-9; angle < 1e-4; angle *= 2)
    for (double bias = 1e-10; bias < 1e-2; bias *= 4)
      if (const double got =
              tilt_rms(*make("tilt-kalman", scene.array,
                             {{"angle_noise", angle}, {"bias_noise", bias}, {"gravity_variance", .0025}}),
                       scene);
          got < best_kalman) {
        best_kalman = got;
        q = angle;
        r = bias;
      }
  fmt::print("tilt, 500 Hz, 800 s, RMS in mrad and relative to the best-tuned Kalman filter\n");
  const auto line = [&](const std::string& name, double rms) {
    fmt::print("{:>44} {:>10.3f} {:>8.3f}\n", name, 1e3 * rms, rms / best_kalman);
  };
  for (const Entry& entry : algorithms())
    if (entry.description->needs.tilt) {
      auto runner = entry.make(scene.array, Settings(entry.options));
      line(std::string(entry.description->name), tilt_rms(*runner, scene));
    }
  line("tilt-complementary, lambda .85 of [RV]",
       tilt_rms(*make("tilt-complementary", scene.array, {{"lambda", .85}}), scene));
  line(fmt::format("best tilt-complementary, tau {:.2g} s", lambda), best_lambda);
  line(fmt::format("best tilt-kalman, Q {:.1e} {:.1e}", q, r), best_kalman);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string what = argc > 1 ? argv[1] : "";
  if (what.empty() || what == "perceptron") perceptron(argc > 2 ? std::stoi(argv[2]) : 6);
  if (what.empty() || what == "takens") takens();
  if (what.empty() || what == "tilt") tilt();
}
