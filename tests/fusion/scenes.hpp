#pragma once
// Scenes that every fusion algorithm has to survive, and what each holds.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "libchar/fusion/array.hpp"
#include "tests/support/noise.hpp"

namespace test {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

struct FusionScene {
  std::string name;
  Eigen::MatrixXd y;      ///< n x N
  Eigen::MatrixXd truth;  ///< 1 x N
  libchar::fusion::Array array;
  bool benign = true;  ///< noise of sound sensors, nothing missing: equivariance is exact up to
                       ///< rounding
};

/// White noise of these variances, flicker a tenth and a walk a thousandth of its deviation.
inline std::vector<libchar::fusion::NoiseModel> drifting(const Eigen::VectorXd& variances) {
  std::vector<libchar::fusion::NoiseModel> models;
  for (const double v : variances) models.push_back({v, 0.1 * std::sqrt(v), 0.001 * std::sqrt(v), {}});
  return models;
}

/// Everything that is in units of the samples, in another unit.
inline void scale_levels(libchar::fusion::Array& array, double factor) {
  array.noise_levels *= factor * factor;
  for (libchar::fusion::NoiseModel& model : array.noise_models) {
    model.white *= factor * factor;
    model.flicker *= factor;
    model.walk *= factor;
  }
}

inline FusionScene noisy_scene(const std::string& name, const Eigen::VectorXd& variances, Eigen::Index instants = 600,
                               double offset = 0, double signal = 2) {
  FusionScene scene;
  scene.name = name;
  const Eigen::Index n = variances.size();
  Gaussian gauss(static_cast<std::uint64_t>(17 + n));
  scene.y.resize(n, instants);
  scene.truth.resize(1, instants);
  double x = 0;
  for (Eigen::Index k = 0; k < instants; ++k) {
    x = 0.7 * x + signal * gauss();
    scene.truth(0, k) = offset + x;
    for (Eigen::Index i = 0; i < n; ++i) scene.y(i, k) = offset + x + std::sqrt(variances[i]) * gauss();
  }
  scene.array.channels = n;
  scene.array.noise_levels = variances;
  if (n <= 10) scene.array.noise_models = drifting(variances);  // not states without end
  scene.array.rate_hz = 200;
  scene.array.learning_samples = instants;
  scene.array.fault_free_samples = instants / 3;
  scene.array.reference_throughout = true;
  scene.array.section_starts = {0, instants / 2};
  return scene;
}

inline FusionScene hurt(FusionScene scene, const std::string& name, const std::function<void(Eigen::MatrixXd&)>& how) {
  how(scene.y);
  scene.name = name;
  scene.benign = false;
  return scene;
}

inline std::vector<FusionScene> fusion_scenes() {
  using Eigen::VectorXd;

  const VectorXd five = (VectorXd(5) << 100, 20, 10, 2, 1).finished() / 50;
  const VectorXd three = (VectorXd(3) << 1, 2, 3).finished();
  const FusionScene sound = noisy_scene("five unequal channels", five);
  std::vector<FusionScene> all{sound,
                               noisy_scene("two channels", (VectorXd(2) << 1, 4).finished()),
                               noisy_scene("three channels", three),
                               noisy_scene("six equal channels", VectorXd::Constant(6, 0.3)),
                               noisy_scene("200 channels", VectorXd::LinSpaced(200, 0.1, 5), 500),
                               noisy_scene("deviations 1 : 1e12", (VectorXd(4) << 1e-12, 1, 1e12, 2).finished()),
                               noisy_scene("offset 10⁹, noise 10⁻⁶", VectorXd::Constant(5, 1e-12), 600, 1e9, 1e-3),
                               noisy_scene("scale 1e-100", five * 1e-200, 600, 0, 1e-100),
                               noisy_scene("one instant", five, 1)};
  for (FusionScene& scene : all)
    if (scene.name != sound.name && scene.name != "six equal channels" && scene.name != "three channels")
      scene.benign = false;
  const auto add = [&](const char* name, const std::function<void(Eigen::MatrixXd&)>& how) {
    all.push_back(hurt(sound, name, how));
  };
  add("all zero", [](Eigen::MatrixXd& y) { y.setZero(); });
  add("all constant", [](Eigen::MatrixXd& y) { y.setConstant(9.81); });
  add("all identical", [](Eigen::MatrixXd& y) { y.rowwise() = Eigen::RowVectorXd(y.row(0)); });
  add("two identical", [](Eigen::MatrixXd& y) { y.row(3) = Eigen::RowVectorXd(y.row(4)); });
  add("one dead", [](Eigen::MatrixXd& y) { y.row(4).setZero(); });
  add("one dies", [](Eigen::MatrixXd& y) { y.row(4).rightCols(y.cols() / 2).setZero(); });
  add("one bit",
      [](Eigen::MatrixXd& y) { y = (y.array() > 0).select(1.0, Eigen::MatrixXd::Constant(y.rows(), y.cols(), -1)); });
  add("saturated", [](Eigen::MatrixXd& y) { y = y.cwiseMax(-1).cwiseMin(1); });
  add("spike 1e300", [](Eigen::MatrixXd& y) { y(2, 250) = 1e300; });
  add("infinite sample", [](Eigen::MatrixXd& y) { y(2, 250) = std::numeric_limits<double>::infinity(); });
  add("lone NaN at both ends", [](Eigen::MatrixXd& y) { y(0, 0) = y(1, y.cols() - 1) = kNaN; });
  add("burst of NaN in one", [](Eigen::MatrixXd& y) { y.row(4).segment(200, 150).setConstant(kNaN); });
  add("burst of NaN in all", [](Eigen::MatrixXd& y) { y.middleCols(200, 150).setConstant(kNaN); });
  add("one channel all NaN", [](Eigen::MatrixXd& y) { y.row(1).setConstant(kNaN); });
  add("all NaN", [](Eigen::MatrixXd& y) { y.setConstant(kNaN); });
  add("random NaN", [](Eigen::MatrixXd& y) {
    Gaussian gauss(5);
    for (Eigen::Index i = 0; i < y.size(); ++i)
      if (gauss.uniform() < 0.3) y.data()[i] = kNaN;
  });
  return all;
}

/// Gyroscope, sine and cosine of a tilt that swings by 40 degrees.
inline FusionScene tilt_scene() {
  FusionScene scene;
  scene.name = "tilt";
  constexpr Eigen::Index kInstants = 600;
  scene.y.resize(3, kInstants);
  scene.truth.resize(1, kInstants);
  Gaussian gauss(3);
  for (Eigen::Index k = 0; k < kInstants; ++k) {
    const double t = static_cast<double>(k + 1) / 100, angle = 0.7 * std::sin(2 * t);
    scene.truth(0, k) = angle;
    scene.y(0, k) = 1.4 * std::cos(2 * t) + 0.01 + 0.02 * gauss();
    scene.y(1, k) = 9.81 * std::sin(angle) + 0.2 * gauss();
    scene.y(2, k) = 9.81 * std::cos(angle) + 0.2 * gauss();
  }
  scene.array.channels = 3;
  scene.array.rate_hz = 100;
  scene.array.tilt = libchar::fusion::TiltChannels{};
  return scene;
}

/// Three channels of two inputs each way: any H.
inline FusionScene lever_scene(Eigen::Index n = 8) {
  FusionScene scene = noisy_scene("two inputs", Eigen::VectorXd::LinSpaced(n, 0.1, 0.5));
  scene.array.observation_matrix.resize(n, 2);
  Gaussian gauss(9);
  Eigen::MatrixXd x(2, scene.y.cols());
  for (Eigen::Index k = 0; k < x.size(); ++k) x.data()[k] = gauss();
  for (Eigen::Index i = 0; i < n; ++i) {
    scene.array.observation_matrix(i, 0) = 1;
    scene.array.observation_matrix(i, 1) = -0.1 * static_cast<double>(i * i);
    for (Eigen::Index k = 0; k < x.cols(); ++k)
      scene.y(i, k) =
          scene.array.observation_matrix.row(i).dot(x.col(k)) + std::sqrt(scene.array.noise_levels[i]) * gauss();
  }
  scene.truth = x;
  return scene;
}

}  // namespace test
