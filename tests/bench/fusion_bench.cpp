// Fusion: cost of a step, and how near the estimates come to the optimum.
//   fusion_bench            nanoseconds a step of every algorithm, n = 6 … 200
//   fusion_bench regret     excess RMS of minque over the optimal weights, scenes 3.1 and 5.1 of
//   [RV]
//   fusion_bench matrices   minque against a matrix for everything at every instant
//   (fusion_plain_bench.py: the same against NumPy)

#include <fmt/format.h>

#include <Eigen/Core>
#include <chrono>
#include <cmath>
#include <cstring>
#include <vector>

#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "tests/support/algebra.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

Eigen::MatrixXd noisy(const Eigen::VectorXd& variances, Eigen::Index instants, std::uint64_t seed, double signal,
                      double* truth = nullptr) {
  test::Gaussian gauss(seed);
  Eigen::MatrixXd y(variances.size(), instants);
  for (Eigen::Index k = 0; k < instants; ++k) {
    const double x = signal * gauss();
    if (truth != nullptr) truth[k] = x;
    for (Eigen::Index i = 0; i < y.rows(); ++i) y(i, k) = x + std::sqrt(variances[i]) * gauss();
  }
  return y;
}

Settings with(const Entry& entry, const std::vector<std::pair<std::string_view, double>>& values) {
  Settings settings(entry.options);
  for (const auto& [name, value] : values) settings.set(name, value);
  return settings;
}

/// RMS of the estimate over RMS of the optimal weights, less one, over the second part of the record.
double excess(const Eigen::VectorXd& variances, const Settings& settings, const char* name, int seeds) {
  constexpr Eigen::Index kInstants = 200000, kFrom = 10000;
  const Eigen::VectorXd w = variances.cwiseInverse() / variances.cwiseInverse().sum();
  double ours = 0, best = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Eigen::MatrixXd y = noisy(variances, kInstants, static_cast<std::uint64_t>(seed), 0);
    Array array;
    array.channels = variances.size();
    auto runner = algorithm(name).make(array, settings);
    Eigen::MatrixXd x(1, kInstants), v(1, kInstants);
    runner->run(y, x, v);
    ours += x.rightCols(kInstants - kFrom).squaredNorm();
    best += (w.transpose() * y).rightCols(kInstants - kFrom).squaredNorm();
  }
  return std::sqrt(ours / best) - 1;
}

void regret(int argc, char** argv) {
  const Eigen::VectorXd t31 = (Eigen::VectorXd(5) << 100, 20, 10, 2, 1).finished();
  const Eigen::VectorXd t51 = (Eigen::VectorXd(6) << .00274, .00487, .00761, .01095, .01491, .01947).finished();
  const Eigen::VectorXd two = (Eigen::VectorXd(5) << 1, 1, 1e4, 1e4, 1e4).finished();
  const Eigen::VectorXd three = (Eigen::VectorXd(5) << 1, 1, 1, 1e4, 1e4).finished();
  std::vector<std::pair<std::string_view, double>> values;
  for (int i = 0; i + 1 < argc; i += 2) values.emplace_back(argv[i], std::stod(argv[i + 1]));
  const Entry& minque = algorithm("minque");
  fmt::print("excess RMS in %: {:>8} {:>8} {:>12} {:>12}\n", "T3.1", "T5.1", "two good", "three good");
  for (const double gamma : {0.9, 0.98, 0.99, 0.995, 0.999, 0.9997}) {
    values.emplace_back("gamma", gamma);
    const Settings settings = with(minque, values);
    fmt::print("gamma {:<10} ", gamma);
    for (const auto* scene : {&t31, &t51, &two, &three})
      fmt::print(" {:9.4f}", 100 * excess(*scene, settings, "minque", 4));
    fmt::print("\n");
  }
}

double nanoseconds(Runner& runner, const Eigen::MatrixXd& y, Eigen::Index inputs) {
  Eigen::MatrixXd x(inputs, y.cols()), v(inputs, y.cols());
  double best = 1e300;
  const int rounds = static_cast<int>(std::max<Eigen::Index>(5, 400000 / y.cols()));
  for (int round = 0; round < rounds; ++round) {
    const auto from = std::chrono::steady_clock::now();
    runner.run(y, x, v);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - from;
    best = std::min(best, took.count() / static_cast<double>(y.cols()));
  }
  return best;
}

/// What every algorithm can be fed: levels, a learnt window, a reference.
void timing() {
  const std::vector<Eigen::Index> sizes{2, 3, 6, 12, 50, 200};
  fmt::print("{:<32}", "ns a step (x mean), n =");
  for (const auto n : sizes) fmt::print("{:>18}", n);
  fmt::print("\n");
  std::vector<double> mean(sizes.size());
  for (const Entry& entry : algorithms()) {
    if (entry.description->needs.tilt) continue;
    fmt::print("{:<32}", entry.description->name);
    for (std::size_t s = 0; s < sizes.size(); ++s) {
      const Eigen::Index n = sizes[s], instants = 4000;
      const Eigen::VectorXd variances = Eigen::VectorXd::LinSpaced(n, 1, 7);
      Array array;
      array.channels = n;
      array.noise_levels = variances;
      array.learning_samples = instants;
      array.reference_throughout = true;
      array.rate_hz = 200;
      if (!why_not(*entry.description, array).empty()) {
        fmt::print("{:>18}", "-");
        continue;
      }
      auto runner = entry.make(array, Settings(entry.options));
      Eigen::MatrixXd truth(1, instants);
      const Eigen::MatrixXd y = noisy(variances, instants, 3, 2, truth.data());
      runner->learn(y, truth);
      runner->finish_learning();
      const double ns = nanoseconds(*runner, y, 1);
      if (entry.description->name == "mean") mean[s] = ns;
      fmt::print("{:>18}", fmt::format("{:.1f} ({:.1f})", ns, ns / mean[s]));
    }
    fmt::print("\n");
  }
}

/// MATLAB's inv and pinv.
Eigen::MatrixXd inverted(const Eigen::MatrixXd& matrix, bool pseudo) {
  return pseudo ? test::pseudo_inverse(matrix) : test::inverse(matrix);
}

/// MINQUE with identity weights and the threshold on the variances as [RV 4, 5] writes them, a
/// matrix at every instant: H of the sensors that are not flagged, P = I - H (H'H)^-1 H', P o P and
/// its inverse, the residuals' moments, the variances, R, R^-1 and the weighted mean. Neither made
/// quicker by structure (H = 1, R diagonal, the same set as before) nor slower than its text.
double plain_minque(const Eigen::MatrixXd& y, bool pseudo) {
  const Eigen::Index n = y.rows();
  const double gamma = 0.999, threshold = 1e4;
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n), moment = mean, variances = mean;
  std::vector<Eigen::Index> healthy(static_cast<std::size_t>(n));
  for (Eigen::Index i = 0; i < n; ++i) healthy[static_cast<std::size_t>(i)] = i;
  double sum = 0;
  for (Eigen::Index k = 0; k < y.cols(); ++k) {
    const auto m = static_cast<Eigen::Index>(healthy.size());
    const Eigen::MatrixXd h = Eigen::MatrixXd::Ones(m, 1);
    const Eigen::VectorXd samples = y.col(k)(healthy);
    const Eigen::MatrixXd p = Eigen::MatrixXd::Identity(m, m) - h * test::inverse(h.transpose() * h) * h.transpose();
    const Eigen::MatrixXd squared = p.cwiseProduct(p);
    const Eigen::VectorXd residual = p * samples, delta = residual - mean(healthy);
    moment(healthy) = gamma * (moment(healthy) + (1 - gamma) * delta.cwiseProduct(delta));
    mean(healthy) += (1 - gamma) * delta;
    const Eigen::VectorXd estimated = inverted(squared, pseudo) * moment(healthy);
    variances(healthy) = estimated.cwiseAbs().cwiseMax(1e-12);
    const Eigen::MatrixXd r = Eigen::VectorXd(variances(healthy)).asDiagonal();
    const Eigen::MatrixXd r_inverse = test::inverse(r);
    const Eigen::MatrixXd x = test::inverse(h.transpose() * r_inverse * h) * h.transpose() * r_inverse * samples;
    sum += x(0, 0);
    healthy.clear();
    for (Eigen::Index i = 0; i < n; ++i)
      if (variances[i] < threshold) healthy.push_back(i);
  }
  return sum;
}

double plain_nanoseconds(const Eigen::MatrixXd& y, bool pseudo) {
  double plain = 1e300, kept = 0;
  // Short and often: a busy machine leaves some of them alone.
  for (int round = 0; round < 300; ++round) {
    const auto from = std::chrono::steady_clock::now();
    kept += plain_minque(y, pseudo);
    const std::chrono::duration<double, std::nano> took = std::chrono::steady_clock::now() - from;
    plain = std::min(plain, took.count() / static_cast<double>(y.cols()));
  }
  return std::isnan(kept) ? kept : plain;
}

void against_matrices() {
  fmt::print("\nMINQUE, ns a step {:>8} {:>22} {:>22}\n", "minque", "matrices, inv (ratio)", "matrices, pinv (ratio)");
  for (const Eigen::Index n : {6, 12, 50}) {
    const Eigen::MatrixXd y = noisy(Eigen::VectorXd::LinSpaced(n, 1, 7), n > 12 ? 20 : 200, 3, 2);
    Array array;
    array.channels = n;
    auto runner = algorithm("minque").make(array, Settings(algorithm("minque").options));
    // Past its start, as in a long record.
    Eigen::MatrixXd x(1, y.cols()), v(1, y.cols());
    for (Eigen::Index k = 0; k < 8000; k += y.cols()) runner->run(y, x, v);
    const double ours = nanoseconds(*runner, y, 1);
    fmt::print("n = {:<13} {:8.1f}", n, ours);
    for (const bool pseudo : {false, true}) {
      const double plain = plain_nanoseconds(y, pseudo);
      fmt::print(" {:>22}", fmt::format("{:.0f} ({:.1f})", plain, plain / ours));
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc > 1 && std::strcmp(argv[1], "regret") == 0)
    regret(argc - 2, argv + 2);
  else if (argc > 1 && std::strcmp(argv[1], "matrices") == 0)
    against_matrices();
  else {
    timing();
    against_matrices();
  }
}
