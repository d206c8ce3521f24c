// Two-fold cross-validation of the terms. On the half A with truth x and samples z (aligned by what A taught)
//   e = z - x,   S = covariance of e on A, a tenth of it shrunk to its diagonal,   w = S^-1 1 / (1' S^-1 1)
// on the half B   RMS of w'(e - mean of e on A)   and RMS of the plain mean of e; then the other way round.
#include "libchar/replay/detail/align/term_choice.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/fusion/aligner.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {
namespace {

using Eigen::Index;

constexpr double kShrinkage = 0.1;
/// An error that grows by less has not grown: halves of a record differ by more.
constexpr double kNoWorse = 1.002;
constexpr Index kFewestJudged = 64;

struct Score {
  double weighted = kNone, mean = kNone;
  bool known() const { return std::isfinite(weighted) && std::isfinite(mean); }
};

bool any(const fusion::AlignmentOptions& o) { return o.delay || o.bias || o.gain || o.misalignment; }

// Columns [from, to) of the data, a whole number of stretches or a part of the only one.
fusion::AlignmentData part(const fusion::AlignmentData& all, Index from, Index to) {
  fusion::AlignmentData out;
  out.channels = all.channels;
  out.samples = all.samples.middleCols(from, to - from);
  out.truth = all.truth.segment(from, to - from);
  for (const Index start : all.starts)
    if (start >= from && start < to) out.starts.push_back(start - from);
  if (out.starts.empty() || out.starts[0] != 0) out.starts.insert(out.starts.begin(), 0);
  return out;
}

// Errors of the channels that have samples at most instants, a column an instant at which all of them and the truth do.
Eigen::MatrixXd errors(const fusion::AlignmentData& data, const fusion::Alignment* alignment,
                       const std::vector<Index>& used) {
  Eigen::MatrixXd samples = data.samples;
  std::optional<fusion::Aligner> aligner;
  if (alignment != nullptr) aligner.emplace(*alignment).clip(samples);
  Eigen::MatrixXd out(static_cast<Index>(used.size()), samples.cols());
  Index filled = 0;
  Eigen::VectorXd column;
  for (std::size_t s = 0; s < data.starts.size(); ++s) {
    const Index end = s + 1 < data.starts.size() ? data.starts[s + 1] : samples.cols();
    for (Index t = data.starts[s] + fusion::kAlignmentMargin; t < end - fusion::kAlignmentMargin; ++t) {
      if (aligner)
        aligner->column(samples, t, column);
      else
        column = samples.col(t).head(data.channels);
      out.col(filled) = column(used).array() - data.truth(t);
      if (out.col(filled).allFinite()) ++filled;
    }
  }
  return out.leftCols(filled);
}

std::vector<Index> present(const fusion::AlignmentData& data) {
  std::vector<Index> out;
  for (Index i = 0; i < data.channels; ++i) {
    const auto row = data.samples.row(i).array();
    double low = std::numeric_limits<double>::infinity(), high = -low;
    Index count = 0;
    for (Index t = 0; t < row.size(); ++t)
      if (std::isfinite(row(t))) {
        low = std::min(low, row(t));
        high = std::max(high, row(t));
        ++count;
      }
    if (2 * count > row.size() && high > low) out.push_back(i);
  }
  return out;
}

// Sums of squares on the other half, and how many.
struct Squares {
  double weighted = 0, mean = 0, count = 0;
};

Squares judged(const Eigen::MatrixXd& taught, const Eigen::MatrixXd& other) {
  const Index n = taught.rows();
  const Eigen::VectorXd centre = taught.rowwise().mean();
  const Eigen::MatrixXd off = taught.colwise() - centre;
  Eigen::MatrixXd covariance = off * off.transpose();
  const Eigen::VectorXd own = covariance.diagonal();
  covariance *= 1 - kShrinkage;
  covariance.diagonal() = own.array() + 1e-12 * own.sum();
  const Eigen::VectorXd solved = covariance.ldlt().solve(Eigen::VectorXd::Ones(n));
  const Eigen::VectorXd w = solved / solved.sum();
  return {(w.transpose() * (other.colwise() - centre)).squaredNorm(), other.colwise().mean().squaredNorm(),
          static_cast<double>(other.cols())};
}

class Halves {
 public:
  explicit Halves(const fusion::AlignmentData& data) : used_(present(data)) {
    const Index m = data.samples.cols();
    const Index cut = data.starts.size() > 1 ? data.starts[data.starts.size() / 2] : m / 2;
    halves_[0] = part(data, 0, cut);
    halves_[1] = part(data, cut, m);
  }

  // NaN where a half cannot teach these terms, or cannot judge them.
  Score score(const fusion::AlignmentOptions& options) const {
    Squares all;
    for (std::size_t teacher = 0; teacher < 2; ++teacher) {
      const fusion::AlignmentData &from = halves_[teacher], &to = halves_[1 - teacher];
      std::optional<fusion::Alignment> learnt;
      try {
        if (any(options)) learnt = fusion::learn_alignment(from, options);
      } catch (const Error&) {
        return {};
      }
      const fusion::Alignment* alignment = learnt ? &*learnt : nullptr;
      const Eigen::MatrixXd taught = errors(from, alignment, used_), other = errors(to, alignment, used_);
      if (used_.empty() || taught.cols() < kFewestJudged || other.cols() < kFewestJudged) return {};
      const Squares one = judged(taught, other);
      all.weighted += one.weighted;
      all.mean += one.mean;
      all.count += one.count;
    }
    return {std::sqrt(all.weighted / all.count), std::sqrt(all.mean / all.count)};
  }

 private:
  std::vector<Index> used_;
  fusion::AlignmentData halves_[2];
};

bool pays(const Score& with, const Score& without) {
  const double better = 1 - kPracticalTolerance;
  return with.known() && with.weighted <= kNoWorse * without.weighted && with.mean <= kNoWorse * without.mean &&
         (with.weighted < better * without.weighted || with.mean < better * without.mean);
}

}  // namespace

TermChoice choose_terms(const fusion::AlignmentData& data, const fusion::AlignmentOptions& allowed) {
  TermChoice out;
  out.options = {false, false, false, false};
  const Halves halves(data);
  Score best = halves.score(out.options);
  if (!best.known()) return out;
  out.trials.push_back({"", best.weighted, best.mean, true});
  const auto attempt = [&](const std::string& term, const fusion::AlignmentOptions& options) {
    const Score score = halves.score(options);
    if (!score.known()) return;
    const bool kept = pays(score, best);
    out.trials.push_back({term, score.weighted, score.mean, kept});
    if (!kept) return;
    best = score;
    out.options = options;
  };
  using Options = fusion::AlignmentOptions;
  const auto add = [&](const char* term, bool Options::*which, std::optional<fusion::Interpolation> by = std::nullopt) {
    if (!(allowed.*which)) return;
    Options options = out.options;
    options.*which = true;
    options.interpolation = by.value_or(options.interpolation);
    attempt(term, options);
  };
  add("bias", &Options::bias);
  add("delay", &Options::delay);
  add("cubic interpolation", &Options::delay, fusion::Interpolation::cubic);
  add("gain", &Options::gain);
  if (data.samples.rows() > data.channels) add("misalignment", &Options::misalignment);
  return out;
}

}  // namespace libchar
