#pragma once
// Published curves as columns of numbers, and how well a model follows them.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <vector>

#include "libchar/fit/fit_result.hpp"

namespace test {

/// All numbers of a text file, in order.
inline std::vector<double> numbers(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::vector<double> values;
  for (double value = 0; in >> value;) values.push_back(value);
  return values;
}

/// Root mean square of log10(a / b).
inline double rms_log10(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(std::log10(a[i] / b[i]), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

/// Of the model against the measured points of a fitted curve.
inline double rms_log10(const libchar::NoiseFit& fit) {
  std::vector<double> measured, model;
  for (const libchar::FitResidual& r : fit.residuals) {
    measured.push_back(r.measured);
    model.push_back(r.model);
  }
  return rms_log10(measured, model);
}

}  // namespace test
