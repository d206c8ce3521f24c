#pragma once
// Allan and Hadamard variances of a record with missing samples, term by term: means over what is
// present of windows more than half there, less what the missing samples add, octave by octave
// (docs/theory/allan.md). No running sums, nothing shared with the library.

#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"

namespace test {

struct PresentTruth {
  long double variance = 0;
  long double inflation = 1;  ///< of its relative standard deviation
  std::uint64_t terms = 0;
};

class PresentReference {
 public:
  using Stride = std::function<std::uint64_t(std::uint64_t m)>;

  /// `stride` of the terms at octaves, which say what the missing samples add.
  PresentReference(const std::vector<double>& y, const Stride& stride) : y_(y) {
    for (std::uint64_t m = 1; 2 * m <= y.size(); m *= 2) {
      const PresentTruth found = at(m, 2, stride(m));
      const long double uneven = unevenness(m, stride(m));
      if (found.terms > 0 && found.variance > 0) {
        top_ += static_cast<long double>(m) * uneven * found.variance;
        bottom_ += uneven;
      }
      spread_.push_back(bottom_ > 0 ? top_ / bottom_ : 0);
    }
  }

  /// At octaves, and (order 3: Hadamard) at anything where nothing lies between them.
  PresentTruth at(std::uint64_t m, int order, std::uint64_t stride) const {
    PresentTruth truth;
    long double squares = 0, short_of = 0;
    for (std::uint64_t i = 0; i + static_cast<std::uint64_t>(order) * m <= y_.size(); i += stride) {
      long double d = 0, less = 0;
      bool whole = true;
      const int weights[2][3] = {{-1, 1, 0}, {1, -2, 1}};
      for (int w = 0; w < order; ++w) {
        const auto [mean, present] = window(i + static_cast<std::uint64_t>(w) * m, m);
        whole = whole && 2 * present > m;
        const long double weight = weights[order - 2][w];
        d += weight * mean;
        less += weight * weight * (1.0L / static_cast<long double>(present) - 1.0L / static_cast<long double>(m));
      }
      if (!whole) continue;
      ++truth.terms;
      squares += d * d;
      short_of += less;
    }
    if (truth.terms == 0) return truth;
    const long double count = (order == 2 ? 2.0L : 6.0L) * static_cast<long double>(truth.terms);
    const auto octave = static_cast<std::size_t>(std::log2(static_cast<double>(m)) + 1e-9);
    const long double spread = octave == 0 ? 0 : spread_[octave - 1];
    const auto type = stride == m ? (order == 2 ? libchar::DeviationType::adev : libchar::DeviationType::hdev)
                                  : (order == 2 ? libchar::DeviationType::oadev : libchar::DeviationType::ohdev);
    correct(truth, squares / count, short_of / count, spread, 1 / static_cast<double>(m),
            white_dof(type, m, truth.terms, stride));
    return truth;
  }

  /// Modified: the mean of the Allan terms at m starts in a row, all of which there must be.
  PresentTruth modified(std::uint64_t m) const {
    PresentTruth truth;
    const auto wide = static_cast<long double>(m);
    long double squares = 0, short_of = 0;
    for (std::uint64_t i = 0; i + 3 * m <= y_.size() + 1; ++i) {
      long double sum = 0, less = 0;
      bool whole = true;
      for (std::uint64_t k = i; k < i + m && whole; ++k) {
        const auto [low, a] = window(k, m);
        const auto [high, b] = window(k + m, m);
        whole = 2 * a > m && 2 * b > m;
        sum += high - low;
        less += 1.0L / static_cast<long double>(a) + 1.0L / static_cast<long double>(b) - 2 / wide;
      }
      if (!whole) continue;
      ++truth.terms;
      squares += sum / wide * (sum / wide);
      short_of += less / wide * (wide * wide + 1) / (2 * wide * wide);
    }
    if (truth.terms == 0) return truth;
    const auto count = 2 * static_cast<long double>(truth.terms);
    const auto octave = static_cast<std::size_t>(std::log2(static_cast<double>(m)) + 1e-9);
    const double unit = static_cast<double>((wide * wide + 1) / (2 * wide * wide * wide)),
                 dof = white_dof(libchar::DeviationType::mdev, m, truth.terms, 1);
    correct(truth, squares / count, short_of / count, octave == 0 ? 0 : spread_[octave - 1], unit, dof);
    return truth;
  }

 private:
  struct Window {
    long double mean;
    std::uint64_t present;
  };

  Window window(std::uint64_t begin, std::uint64_t m) const {
    long double sum = 0;
    std::uint64_t present = 0;
    for (std::uint64_t i = begin; i < begin + m; ++i)
      if (std::isfinite(y_[i])) {
        sum += static_cast<long double>(y_[i]);
        ++present;
      }
    return {sum / static_cast<long double>(present), present};
  }

  /// Degrees of freedom of the terms in white noise, by the library.
  static double white_dof(libchar::DeviationType type, std::uint64_t m, std::uint64_t terms, std::uint64_t stride) {
    libchar::AllanCurve curve;
    curve.type = type;
    if (stride > 1 && stride < m) curve.stride_divisor = m / stride;
    curve.points.resize(1);
    curve.points[0].m = m;
    curve.points[0].tau_s = static_cast<double>(m);
    curve.points[0].deviation = 1;
    curve.points[0].terms = terms;
    libchar::add_intervals(curve, {1});
    return curve.points[0].edf;
  }

  static void correct(PresentTruth& truth, long double before, long double c, long double spread, double of_white,
                      double dof) {
    truth.variance = before;
    if (c < 1e-15L) return;
    const double unit = 2 / (9 * dof);
    const long double white = 1 + c / static_cast<long double>(of_white);
    const long double ratio = before / (spread * white * static_cast<long double>(of_white));
    const long double z = (std::cbrt(ratio) - (1 - unit)) / std::sqrt(unit);
    const long double w = 1 / (1 + z * z * z * z / 16);
    const long double less = before - c * spread, rest = less > 0 ? 1 - w : 0;
    truth.variance = w * before / white + rest * less;
    truth.inflation = (w / white + rest) * before / truth.variance;
  }

  long double unevenness(std::uint64_t m, std::uint64_t stride) const {
    long double sum = 0;
    std::uint64_t starts = 0;
    for (std::uint64_t i = 0; i + 2 * m <= y_.size(); i += stride, ++starts) {
      const auto a = static_cast<long double>(window(i, m).present),
                 b = static_cast<long double>(window(i + m, m).present);
      sum += (b - a) * (b - a) / static_cast<long double>(m * m);
    }
    return sum / static_cast<long double>(starts);
  }

  std::vector<double> y_;
  long double top_ = 0, bottom_ = 0;
  std::vector<long double> spread_;
};

}  // namespace test
