#include "tests/fit/strd.hpp"

#include <ceres/ceres.h>

#include <stdexcept>

#include "libchar/core/process/silent_glog.hpp"
#include "libchar/fit/detail/curve/ceres_options.hpp"

namespace test {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// As printed in the .dat files; b counts from zero.
template <class T>
T strd_model(const std::string& name, const T* b, const double* x) {
  using std::atan, std::cos, std::exp, std::pow, std::sin, std::sqrt;
  const double v = x[0];
  const std::string family = name.substr(0, name.find_last_not_of("0123456789") + 1);
  if (name == "Bennett5") return b[0] * pow(b[1] + v, -1.0 / b[2]);
  if (name == "BoxBOD" || name == "Misra1a") return b[0] * (1.0 - exp(-b[1] * v));
  if (family == "Chwirut") return exp(-b[0] * v) / (b[1] + b[2] * v);
  if (name == "DanWood") return b[0] * pow(T(v), b[1]);
  if (name == "ENSO")
    return b[0] + b[1] * cos(2 * kPi * v / 12) + b[2] * sin(2 * kPi * v / 12) + b[4] * cos(2 * kPi * v / b[3]) +
           b[5] * sin(2 * kPi * v / b[3]) + b[7] * cos(2 * kPi * v / b[6]) + b[8] * sin(2 * kPi * v / b[6]);
  if (name == "Eckerle4") return b[0] / b[1] * exp(-0.5 * (v - b[2]) * (v - b[2]) / (b[1] * b[1]));
  if (family == "Gauss")
    return b[0] * exp(-b[1] * v) + b[2] * exp(-(v - b[3]) * (v - b[3]) / (b[4] * b[4])) +
           b[5] * exp(-(v - b[6]) * (v - b[6]) / (b[7] * b[7]));
  if (name == "Hahn1" || name == "Thurber")
    return (b[0] + v * (b[1] + v * (b[2] + v * b[3]))) / (1.0 + v * (b[4] + v * (b[5] + v * b[6])));
  if (name == "Kirby2") return (b[0] + v * (b[1] + v * b[2])) / (1.0 + v * (b[3] + v * b[4]));
  if (family == "Lanczos") return b[0] * exp(-b[1] * v) + b[2] * exp(-b[3] * v) + b[4] * exp(-b[5] * v);
  if (name == "MGH09") return b[0] * (v * v + v * b[1]) / (v * v + v * b[2] + b[3]);
  if (name == "MGH10") return b[0] * exp(b[1] / (v + b[2]));
  if (name == "MGH17") return b[0] + b[1] * exp(-v * b[3]) + b[2] * exp(-v * b[4]);
  if (name == "Misra1b") return b[0] * (1.0 - pow(1.0 + b[1] * v / 2.0, -2.0));
  if (name == "Misra1c") return b[0] * (1.0 - pow(1.0 + 2.0 * b[1] * v, -0.5));
  if (name == "Misra1d") return b[0] * b[1] * v / (1.0 + b[1] * v);
  if (name == "Nelson") return b[0] - b[1] * v * exp(-b[2] * x[1]);
  if (name == "Rat42") return b[0] / (1.0 + exp(b[1] - b[2] * v));
  if (name == "Rat43") return b[0] / pow(1.0 + exp(b[1] - b[2] * v), 1.0 / b[3]);
  if (name == "Roszman1") return b[0] - b[1] * v - atan(b[2] / (v - b[3])) / kPi;
  throw std::runtime_error("no such problem: " + name);
}

/// Of b = scale * u. Covariances are taken at u = 1, in shares of the solution as our fits take them (of ln theta): a
/// direction counts as not determined by how small it is beside the others, which units must not decide.
struct StrdResidual {
  const StrdProblem* problem;
  const StrdRow* row;
  std::vector<double> scale;
  template <class T>
  bool operator()(T const* const* u, T* out) const {
    std::vector<T> b(scale.size());
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = scale[i] * u[0][i];
    out[0] = strd_model(problem->name, b.data(), row->x.data()) - row->y;
    using std::isfinite;
    return isfinite(out[0]);
  }
};

void add_residuals(const StrdProblem& problem, const std::vector<double>& scale, double* u, ceres::Problem& to) {
  for (const StrdRow& row : problem.rows) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<StrdResidual, 4>(new StrdResidual{&problem, &row, scale});
    cost->AddParameterBlock(static_cast<int>(scale.size()));
    cost->SetNumResiduals(1);
    to.AddResidualBlock(cost, nullptr, u);
  }
}

ceres::Solver::Options settings(bool own) {
  if (own) return libchar::exact_solver_options(10000);
  ceres::Solver::Options options;
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

StrdSolution solved(const StrdProblem& problem, const std::vector<double>& start, bool own_settings) {
  const libchar::SilentGlog silent;
  StrdSolution out{start, {}, INFINITY};
  ceres::Problem as_given;
  add_residuals(problem, std::vector<double>(start.size(), 1), out.b.data(), as_given);
  ceres::Solver::Summary summary;
  ceres::Solve(settings(own_settings), &as_given, &summary);
  if (!summary.IsSolutionUsable()) return out;
  out.cost = summary.final_cost;
  std::vector<double> ones(start.size(), 1), block(start.size() * start.size());
  ceres::Problem in_shares;
  add_residuals(problem, out.b, ones.data(), in_shares);
  ceres::Covariance covariance(libchar::exact_covariance_options());
  const std::vector<std::pair<const double*, const double*>> wanted = {{ones.data(), ones.data()}};
  if (!covariance.Compute(wanted, &in_shares) || !covariance.GetCovarianceBlock(ones.data(), ones.data(), block.data()))
    return out;
  const double s2 = 2 * out.cost / static_cast<double>(problem.rows.size() - start.size());
  for (std::size_t i = 0; i < start.size(); ++i)
    out.se.push_back(std::abs(out.b[i]) * std::sqrt(s2 * block[i * (start.size() + 1)]));
  return out;
}

std::array<double, 3> solver_tolerances() {
  const ceres::Solver::Options options = libchar::exact_solver_options(50);
  return {options.function_tolerance, options.gradient_tolerance, options.parameter_tolerance};
}

}  // namespace test
