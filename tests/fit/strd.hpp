#pragma once
// NIST's nonlinear reference problems and their solution by Ceres: apart from the tests, whose CHECK glog has too.

#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace test {

struct StrdRow {
  double y = 0;
  std::array<double, 2> x{};
};

struct StrdProblem {
  std::string name;
  std::vector<StrdRow> rows;
  std::array<std::vector<double>, 2> starts;
  std::vector<double> certified, se;
};

struct StrdSolution {
  std::vector<double> b, se;
  double cost = INFINITY;
};

/// With our settings, or with Ceres' own.
StrdSolution solved(const StrdProblem& problem, const std::vector<double>& start, bool own_settings = true);

/// Our tolerances: function, gradient, parameter.
std::array<double, 3> solver_tolerances();

}  // namespace test
