#include "libchar/fusion/detail/variances/general_mean.hpp"

namespace libchar::fusion {

GeneralMean::GeneralMean(const Eigen::MatrixXd& h, const Eigen::VectorXd& variances)
    : gls_(h), variances_(variances), residual_(h.rows()) {
  present_.reserve(static_cast<std::size_t>(h.rows()));
  before_.reserve(present_.capacity());
  for (int i = 0; i < h.rows(); ++i) present_.push_back(i);
  determined_ = gls_.factor(variances_.data(), present_.data(), static_cast<int>(present_.size()));
}

// The factors refer to the list `present_`, so that it is only written when it changes.
bool GeneralMean::take_present(const Sample& y) {
  before_.clear();
  for (int i = 0; i < y.size(); ++i)
    if (usable(y[i])) before_.push_back(i);
  if (before_ == present_) return determined_;
  present_.assign(before_.begin(), before_.end());
  determined_ = !present_.empty() &&
                gls_.factor(variances_.data(), present_.data(), static_cast<int>(present_.size()));
  return determined_;
}

Estimate GeneralMean::step(const Sample& y) {
  Estimate estimate = Estimate::none(gls_.inputs());
  if (!take_present(y)) return estimate;
  gls_.solve(y.data(), estimate.x.data(), residual_.data());
  for (Eigen::Index j = 0; j < gls_.inputs(); ++j) estimate.variance[j] = gls_.variance(j);
  return estimate;
}

Eigen::MatrixXd GeneralMean::weights() const {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(gls_.h().rows(), gls_.inputs());
  if (!determined_) return out;
  const Eigen::MatrixXd gain = gls_.gain();
  for (std::size_t k = 0; k < present_.size(); ++k)
    out.row(present_[k]) = gain.col(static_cast<Eigen::Index>(k)).transpose();
  return out;
}

}  // namespace libchar::fusion
