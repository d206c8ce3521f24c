#include "libchar/fusion/detail/bias/riccati.hpp"

#include "libchar/core/numeric/dense.hpp"

namespace libchar::fusion {
namespace {

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& m) { return 0.5 * (m + m.transpose()); }

Eigen::MatrixXd one_plus(Eigen::MatrixXd m) {
  m.diagonal().array() += 1;
  return m;
}

}  // namespace

RiccatiSteps::RiccatiSteps(const Eigen::MatrixXd& transition, const Eigen::MatrixXd& drive,
                           const Eigen::MatrixXd& information)
    : a_(transition.transpose()), g_(information), h_(drive) {}

Eigen::MatrixXd RiccatiSteps::advance(const Eigen::MatrixXd& p) const {
  // P (I + G P)^-1 = ((I + P G)^-1 P), both symmetric.
  const Eigen::MatrixXd updated = symmetric(general_solve(one_plus(p * g_), p));
  return h_ + symmetric(a_.transpose() * updated * a_);
}

void RiccatiSteps::twice() {
  const Eigen::MatrixXd w = one_plus(g_ * h_);
  const Eigen::MatrixXd a = general_solve(w, a_), g = general_solve(w, g_);
  const Eigen::MatrixXd h = symmetric(a_.transpose() * h_ * a);
  g_ += symmetric(a_ * g * a_.transpose());
  h_ += h;
  a_ *= a;
}

const Eigen::MatrixXd& RiccatiSteps::steady() {
  constexpr int kMost = 80;  // 2^80 steps are for ever
  for (int doubling = 0; doubling < kMost; ++doubling) {
    const Eigen::MatrixXd before = h_;
    twice();
    if ((h_ - before).norm() <= 1e-15 * h_.norm()) break;
  }
  return h_;
}

}  // namespace libchar::fusion
