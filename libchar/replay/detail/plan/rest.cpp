#include "libchar/replay/detail/plan/rest.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace libchar {

void RestMeter::push(const Eigen::MatrixXd& samples) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    Sums& s = sensors_[i];
    for (Eigen::Index k = 0; k < samples.cols(); ++k) {
      const double y = samples(static_cast<Eigen::Index>(i), k);
      if (!std::isfinite(y)) {
        s.has_last = false;
        continue;
      }
      if (s.samples == 0) s.origin = y;  // an offset must cost no digits
      s.sum += y - s.origin;
      s.squares += (y - s.origin) * (y - s.origin);
      ++s.samples;
      if (s.has_last) {
        s.differences += (y - s.last) * (y - s.last);
        ++s.pairs;
      }
      s.last = y;
      s.has_last = true;
    }
  }
}

std::vector<double> RestMeter::means() const {
  std::vector<double> out;
  for (const Sums& s : sensors_) out.push_back(s.samples > 0 ? s.origin + s.sum / static_cast<double>(s.samples) : 0);
  return out;
}

std::vector<double> RestMeter::noise_variances() const {
  std::vector<double> out;
  for (const Sums& s : sensors_)
    out.push_back(s.pairs > 0 ? s.differences / (2 * static_cast<double>(s.pairs))
                              : std::numeric_limits<double>::quiet_NaN());
  return out;
}

std::vector<double> RestMeter::variances() const {
  std::vector<double> out;
  for (const Sums& s : sensors_) {
    const auto n = static_cast<double>(s.samples);
    out.push_back(n > 1 ? std::max(0.0, (s.squares - s.sum * s.sum / n) / (n - 1))
                        : std::numeric_limits<double>::quiet_NaN());
  }
  return out;
}

}  // namespace libchar
