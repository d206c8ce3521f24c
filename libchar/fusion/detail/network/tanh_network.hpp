#pragma once
// A network of one hidden layer:  out = c + sum_j v_j tanh(b_j + sum_i W_ji z_i)       [RV 3.7]
// Parameters in one vector: W (hidden x inputs, row after row), b, v, c.

#include <cmath>
#include <cstddef>

namespace libchar::fusion {

struct TanhNetwork {
  std::size_t inputs = 1, hidden = 1;

  std::size_t size() const { return hidden * (inputs + 2) + 1; }
  std::size_t b() const { return hidden * inputs; }  ///< where b begins
  std::size_t v() const { return b() + hidden; }
  std::size_t c() const { return v() + hidden; }

  double activation(const double* p, std::size_t j, const double* z) const {
    const double* const w = p + j * inputs;
    double sum = p[b() + j];
    for (std::size_t i = 0; i < inputs; ++i) sum += w[i] * z[i];
    return std::tanh(sum);
  }
  double output(const double* p, const double* z) const {
    double out = p[c()];
    for (std::size_t j = 0; j < hidden; ++j) out += p[v() + j] * activation(p, j, z);
    return out;
  }
  /// Output, and its derivatives by every parameter in `row` (size() of them):
  /// by W_ji v_j (1 - t_j^2) z_i, by b_j v_j (1 - t_j^2), by v_j t_j, by c 1.
  double output(const double* p, const double* z, double* row) const {
    double out = p[c()];
    for (std::size_t j = 0; j < hidden; ++j) {
      const double t = activation(p, j, z), slope = p[v() + j] * (1 - t) * (1 + t);
      for (std::size_t i = 0; i < inputs; ++i) row[j * inputs + i] = slope * z[i];
      row[b() + j] = slope;
      row[v() + j] = t;
      out += p[v() + j] * t;
    }
    row[c()] = 1;
    return out;
  }
};

}  // namespace libchar::fusion
