#pragma once
// The 50-digit vectors of fixtures/known/fusion, and algorithms run on them in one or several blocks.

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "tests/support/shared.hpp"
#include "tests/support/table.hpp"

namespace test {

/// A CSV file of numbers with one header line; columns by name.
struct Vectors {
  std::vector<std::string> names;
  Eigen::MatrixXd values;  ///< a row a line of the file

  explicit Vectors(const std::string& file) {
    const auto rows = table(known("fusion/" + file));
    names = rows.at(0);
    values.resize(static_cast<Eigen::Index>(rows.size()) - 1, static_cast<Eigen::Index>(names.size()));
    for (Eigen::Index r = 0; r < values.rows(); ++r)
      for (Eigen::Index c = 0; c < values.cols(); ++c)
        values(r, c) = std::stod(rows[static_cast<std::size_t>(r) + 1].at(static_cast<std::size_t>(c)));
  }
  Eigen::Index column(const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name) return static_cast<Eigen::Index>(i);
    throw std::runtime_error("no column " + name);
  }
  Eigen::VectorXd operator[](const std::string& name) const { return values.col(column(name)); }
  /// Columns PREFIX1 … PREFIXn, transposed: one column an instant.
  Eigen::MatrixXd block(const std::string& prefix, Eigen::Index n) const {
    return values.middleCols(column(prefix + "1"), n).transpose();
  }
};

inline nlohmann::json answers() { return nlohmann::json::parse(slurp(known("fusion/kat.json"))); }

inline Eigen::VectorXd vector(const nlohmann::json& list) {
  const std::vector<double> values = list;
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

/// NaN equals NaN.
inline bool same_values(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return false;
  for (Eigen::Index i = 0; i < a.size(); ++i)
    if (!(a.data()[i] == b.data()[i] || (std::isnan(a.data()[i]) && std::isnan(b.data()[i])))) return false;
  return true;
}

struct Run {
  Eigen::MatrixXd x, variance;
};

inline Run run(libchar::fusion::Runner& runner, const Eigen::MatrixXd& samples, Eigen::Index inputs = 1,
               Eigen::Index block = std::numeric_limits<Eigen::Index>::max()) {
  Run out{Eigen::MatrixXd(inputs, samples.cols()), Eigen::MatrixXd(inputs, samples.cols())};
  for (Eigen::Index k = 0; k < samples.cols();) {
    const Eigen::Index size = std::min(block, samples.cols() - k);
    runner.run(samples.middleCols(k, size), out.x.middleCols(k, size), out.variance.middleCols(k, size));
    k += size;
  }
  return out;
}

using Values = std::vector<std::pair<std::string, double>>;

inline libchar::fusion::Settings settings(const std::string& name, const Values& values) {
  libchar::fusion::Settings made(libchar::fusion::algorithm(name).options);
  for (const auto& [option, value] : values) made.set(option, value);
  return made;
}

inline std::unique_ptr<libchar::fusion::Runner> make(const std::string& name, const libchar::fusion::Array& array,
                                                     const Values& values = {}) {
  return libchar::fusion::algorithm(name).make(array, settings(name, values));
}

inline libchar::fusion::Array array(Eigen::Index channels) {
  libchar::fusion::Array made;
  made.channels = channels;
  return made;
}

/// Largest |a - b| in units of the tolerance 10 x max(absolute, relative x |b|): below 1 passes.
inline double worst(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double absolute, double relative = 0) {
  double worst = 0;
  for (Eigen::Index i = 0; i < b.size(); ++i) {
    const double tolerance = 10 * std::max(absolute, relative * std::abs(b.data()[i]));
    const double off = std::abs(a.data()[i] - b.data()[i]) / tolerance;
    if (!(off <= worst)) worst = std::isnan(off) ? std::numeric_limits<double>::infinity() : off;
  }
  return worst;
}

}  // namespace test
