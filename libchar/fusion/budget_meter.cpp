// With x the reference, or the mean of the aligned channels, u = y - x, and u' the same without the
// delay that was learnt: the mean square of u' is split by projecting in turn on 1, x, the other axes
// c_k and dx/dt (QR of the regressors): offset, gain, cross-axis, and a delay that is left; what u has
// more than u' is the delay's too. Of what alignment leaves, r, the part that follows (dx/dt)^2,
//   r^2 = noise + jitter^2 (dx/dt)^2,
// is a delay that jitters: its sign changes, its size is that of the slope. The rest is noise.
#include "libchar/fusion/budget_meter.hpp"

#include <algorithm>
#include <cmath>

namespace libchar::fusion {
namespace {

using Index = Eigen::Index;
constexpr std::int64_t kBatches = 30;
constexpr std::size_t kFewestBatches = 8;
constexpr double kNormal95 = 2.045;  // Student, 29 degrees of freedom

}  // namespace

BudgetMeter::BudgetMeter(Index channels, Index axes, std::int64_t instants, bool with_truth)
    : n_(channels),
      axes_(axes),
      batch_(std::max<std::int64_t>(16, (instants + kBatches - 1) / kBatches)),
      with_truth_(with_truth),
      c0_(Eigen::VectorXd::Zero(axes)) {}

void BudgetMeter::push(const Eigen::VectorXd& recorded, const Eigen::VectorXd& undelayed,
                       const Eigen::VectorXd& aligned, const Eigen::VectorXd& cross, double truth) {
  Instant now{recorded, undelayed, aligned, cross, with_truth_ ? truth : aligned.mean(), false};
  now.complete = recorded.allFinite() && aligned.allFinite() && cross.allFinite() && std::isfinite(now.x);
  if (std::isnan(x0_) && now.complete) {
    x0_ = now.x;
    c0_ = cross;
  }
  if (seen_ >= 2 && last_[0].complete && last_[1].complete && now.complete) add(last_[0], last_[1], now);
  last_[0] = std::move(last_[1]);
  last_[1] = std::move(now);
  ++seen_;
}

void BudgetMeter::add(const Instant& before, const Instant& now, const Instant& after) {
  const auto b = static_cast<std::size_t>((seen_ - 1) / batch_);
  const Index p = 3 + axes_;
  while (batches_.size() <= b)
    batches_.push_back({Eigen::MatrixXd::Zero(p, p), Eigen::MatrixXd::Zero(p, n_ + 1), Eigen::VectorXd::Zero(n_ + 1),
                        Eigen::VectorXd::Zero(n_ + 1), Eigen::VectorXd::Zero(n_ + 1), Eigen::VectorXd::Zero(n_ + 1)});
  Sums& s = batches_[b];
  const double slope = 0.5 * (after.x - before.x), slope2 = slope * slope;
  Eigen::VectorXd row(p), u(n_ + 1), d(n_ + 1), r(n_ + 1);
  row << 1, now.x - x0_, now.cross - c0_, slope;
  u.head(n_) = now.recorded.array() - now.x;
  r.head(n_) = now.aligned.array() - now.x;
  d.head(n_) = now.undelayed.array() - now.x;
  u(n_) = u.head(n_).mean();
  d(n_) = d.head(n_).mean();
  r(n_) = r.head(n_).mean();
  s.regressors += row * row.transpose();
  s.errors += row * d.transpose();
  s.squares += u.cwiseAbs2();
  s.undelayed += d.cwiseAbs2();
  s.rest += r.cwiseAbs2();
  s.rest_slope += slope2 * r.cwiseAbs2();
  s.slope2 += slope2;
  s.slope4 += slope2 * slope2;
  s.count += 1;
  const auto n = static_cast<double>(n_);
  const double others = (n / (n - 1)) * (n / (n - 1)) / n;
  s.before += with_truth_ ? u(n_) * u(n_) : others * (now.recorded.array() - now.recorded.mean()).square().sum();
  s.after += with_truth_ ? r(n_) * r(n_) : others * (now.aligned.array() - now.aligned.mean()).square().sum();
}

BudgetMeter::Sums BudgetMeter::total(std::size_t without) const {
  Sums out;
  for (std::size_t b = 0; b < batches_.size(); ++b) {
    const Sums& s = batches_[b];
    if (b == without) continue;
    if (out.count == 0 && out.regressors.size() == 0) {
      out = s;
      continue;
    }
    out.regressors += s.regressors;
    out.errors += s.errors;
    out.squares += s.squares;
    out.undelayed += s.undelayed;
    out.rest += s.rest;
    out.rest_slope += s.rest_slope;
    out.slope2 += s.slope2;
    out.slope4 += s.slope4;
    out.count += s.count;
    out.before += s.before;
    out.after += s.after;
  }
  return out;
}

// A row a part, a column a channel and last their mean: mean squares. `loadings`: the signed roots of
// offset, gain, each axis and delay.
Eigen::MatrixXd BudgetMeter::powers(const Sums& s, Eigen::MatrixXd* loadings) const {
  const Index p = s.regressors.rows();
  // R of the QR of the regressors, row by row of Cholesky; what says nothing new gets nothing.
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(p, p);
  for (Index j = 0; j < p; ++j) {
    const double d = s.regressors(j, j) - lower.row(j).head(j).squaredNorm();
    if (!(d > 1e-12 * s.regressors(j, j))) continue;
    lower(j, j) = std::sqrt(d);
    for (Index i = j + 1; i < p; ++i)
      lower(i, j) = (s.regressors(i, j) - lower.row(i).head(j).dot(lower.row(j).head(j))) / lower(j, j);
  }
  Eigen::MatrixXd q = Eigen::MatrixXd::Zero(p, n_ + 1);
  for (Index j = 0; j < p; ++j)
    if (lower(j, j) > 0) q.row(j) = (s.errors.row(j) - lower.row(j).head(j) * q.topRows(j)) / lower(j, j);
  q /= std::sqrt(s.count);
  Eigen::MatrixXd out(static_cast<Index>(kErrorParts), n_ + 1);
  const double mean = s.slope2 / s.count, spread = s.slope4 / s.count - mean * mean;
  for (Index i = 0; i <= n_; ++i) {
    const double all = s.squares(i) / s.count;
    out(0, i) = q(0, i) * q(0, i);
    out(1, i) = q(1, i) * q(1, i);
    out(2, i) = q.col(i).segment(2, axes_).squaredNorm();
    const double behind = std::max(0.0, all - out.col(i).head(3).sum());
    const double removed = (s.squares(i) - s.undelayed(i)) / s.count;
    out(3, i) = std::clamp(q(p - 1, i) * q(p - 1, i) + removed, 0.0, behind);
    const double left = behind - out(3, i);
    const double follows = spread > 0 ? (s.rest_slope(i) / s.count - mean * s.rest(i) / s.count) / spread : 0;
    out(4, i) = std::clamp(follows * mean, 0.0, left);
    out(5, i) = left - out(4, i);
  }
  if (loadings != nullptr) *loadings = q;
  return out;
}

ErrorBudget BudgetMeter::result() const {
  ErrorBudget out;
  out.channels.resize(static_cast<std::size_t>(n_));
  out.savings.assign(kErrorParts, kNoOrigin);
  const Sums all = total(batches_.size());
  out.instants = static_cast<std::int64_t>(all.count);
  if (all.count < 16) {
    out.before = out.after = kNoOrigin;
    for (ChannelBudget& c : out.channels) c.rms = kNoOrigin;
    return out;
  }
  out.before = std::sqrt(all.before / all.count);
  out.after = std::sqrt(all.after / all.count);
  Eigen::MatrixXd loadings;
  const Eigen::MatrixXd power = powers(all, &loadings);
  std::vector<Eigen::MatrixXd> without;
  for (std::size_t b = 0; b < batches_.size(); ++b)
    if (batches_[b].count > 0 && batches_[b].count < all.count) without.push_back(powers(total(b), nullptr));
  const auto parts = static_cast<Index>(kErrorParts);
  // Blind: the channels' own errors, taken together, are what leaving one out shows.
  const double everything = with_truth_ ? power.col(n_).sum() : power.leftCols(n_).sum();
  const auto saving = [&](double gone) {
    return everything > 0 ? 1 - std::sqrt(std::max(0.0, 1 - gone / everything)) : 0;
  };
  const auto n = static_cast<double>(n_);
  const auto gone = [&](Index part, Index i) {
    if (!with_truth_) return power(part, i);
    if (part >= 4) return std::min(power(part, i) / (n * n), power(part, n_));
    const Index from = part < 3 ? part : loadings.rows() - 1, size = part == 2 ? axes_ : 1;
    const auto own = loadings.col(i).segment(from, size), mean = loadings.col(n_).segment(from, size);
    return 2 / n * own.dot(mean) - own.squaredNorm() / (n * n);
  };
  for (Index i = 0; i < n_; ++i) {
    ChannelBudget& c = out.channels[static_cast<std::size_t>(i)];
    const double whole = power.col(i).sum();
    c.rms = std::sqrt(whole);
    for (Index part = 0; part < parts; ++part) {
      PartShare share{whole > 0 ? power(part, i) / whole : 0, {kNoOrigin, kNoOrigin}, 0};
      share.saving = saving(gone(part, i));
      if (without.size() >= kFewestBatches && whole > 0) {
        double sum = 0, squares = 0;
        const auto count = static_cast<double>(without.size());
        for (const Eigen::MatrixXd& w : without) sum += w(part, i) / w.col(i).sum();
        for (const Eigen::MatrixXd& w : without) squares += std::pow(w(part, i) / w.col(i).sum() - sum / count, 2);
        const double half = kNormal95 * std::sqrt(squares * (count - 1) / count);
        share.ci95 = {std::max(0.0, share.share - half), std::min(1.0, share.share + half)};
      }
      c.parts.push_back(share);
    }
  }
  for (Index part = 0; part < parts; ++part)
    out.savings[static_cast<std::size_t>(part)] =
        saving(with_truth_ ? power(part, n_) : power.row(part).head(n_).sum());
  return out;
}

}  // namespace libchar::fusion
