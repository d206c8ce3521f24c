// Line of least squares in one pass (Welford 1962; Chan, Golub, LeVeque 1983): with running means m_t, m_y of n values
//   S_tt += (t - m_t)(t - m_t'),   S_ty += (t - m_t)(y - m_y'),   slope = S_ty / S_tt
#include "libchar/replay/detail/plan/preparation.hpp"

#include <cmath>

namespace libchar {

void TrendMeter::push(std::int64_t first, const Eigen::MatrixXd& series) {
  sums_.resize(static_cast<std::size_t>(series.rows()));
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    Sums& s = sums_[i];
    for (Eigen::Index k = 0; k < series.cols(); ++k) {
      const double y = series(static_cast<Eigen::Index>(i), k);
      if (!std::isfinite(y)) continue;
      s.n += 1;
      const double before = static_cast<double>(first + k) - s.time;
      s.time += before / s.n;
      s.value += (y - s.value) / s.n;
      s.time_squares += before * (static_cast<double>(first + k) - s.time);
      s.products += before * (y - s.value);
    }
  }
}

std::vector<TrendLine> TrendMeter::lines(bool sloped) const {
  std::vector<TrendLine> out;
  for (const Sums& s : sums_)
    out.push_back({s.value, sloped && s.time_squares > 0 ? s.products / s.time_squares : 0, s.time});
  return out;
}

Prepared::Prepared(const Preparation& preparation, std::size_t rows) : preparation_(&preparation) {
  if (preparation.filter) channels_.assign(rows, FilteredChannel(*preparation.filter));
}

double Prepared::operator()(std::size_t row, std::int64_t instant, double value) {
  if (!preparation_->trends.empty()) value -= preparation_->trends[row].at(instant);
  return channels_.empty() ? value : channels_[row](value);
}

}  // namespace libchar
