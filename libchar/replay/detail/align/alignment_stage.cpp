#include "libchar/replay/detail/align/alignment_stage.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/aligner.hpp"
#include "libchar/fusion/alignment_learning.hpp"
#include "libchar/fusion/budget_meter.hpp"
#include "libchar/replay/detail/align/instants.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

// Two-fold cross-validation of the terms. On the half A with truth x and samples z (aligned by what A taught)
//   e = z - x,   S = covariance of e on A, a tenth of it shrunk to its diagonal,   w = S^-1 1 / (1' S^-1 1)
// on the half B   RMS of w'(e - mean of e on A)   and RMS of the plain mean of e; then the other way round.

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
  const Index margin = alignment != nullptr ? fusion::margin_of(*alignment) : fusion::kAlignmentMargin;
  for (std::size_t s = 0; s < data.starts.size(); ++s) {
    const Index end = s + 1 < data.starts.size() ? data.starts[s + 1] : samples.cols();
    for (Index t = data.starts[s] + margin; t < end - margin; ++t) {
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

namespace {

constexpr std::size_t kLearningBlockOfAlignment = 2048;
/// Samples held in memory while an alignment is learnt.
constexpr std::int64_t kMostValues = std::int64_t{1} << 20;
constexpr std::int64_t kStretches = 64;
/// Instants of a stretch: its ends, where interpolation has no neighbours, are a small part of it.
constexpr std::int64_t kShortestStretch = 256;
/// Values that are enough to tell which terms pay: each is learnt twice.
constexpr std::int64_t kMostTried = std::int64_t{1} << 18;

struct LearningWindow {
  std::int64_t from = 0, to = 0;
};

LearningWindow window_of_alignment(const Scene& scene, const ReplayPlan& plan, const Instants& instants) {
  const SceneAlign& align = *scene.align;
  if (align.learn == "run") return {std::clamp(instants.settled(), plan.run_from, plan.run_to), plan.run_to};
  const bool learning = align.learn == "learning";
  const TimeWindow& w = learning ? plan.learning : align.window ? *align.window : *scene.rest;
  LearningWindow out{plan.learn_from, plan.learn_to};
  if (!learning) out = {std::max(instants.instant_at(w.from_s), instants.settled()), instants.instant_at(w.to_s)};
  if (out.to - out.from < 2 && instants.settled() > instants.instant_at(w.from_s))
    throw usage_error("E0939", scene.file)
        .says("align: the window ends before the filter has settled, which takes " +
              duration_text(static_cast<double>(instants.settled()) / instants.info().rate_hz))
        .got("from {} s", brief_text(w.from_s, 6))
        .hint("a later or longer window, or a filter of a higher corner");
  if (out.to - out.from < 2)
    throw input_error("E0903", scene.file)
        .says("align: the window holds fewer than two instants of the recording")
        .got("from {} s", brief_text(w.from_s, 6));
  return out;
}

Eigen::VectorXd weights_of(const Scene& scene, const Instants& instants) {
  if (instants.info().input_names.size() != 1)
    throw input_error("E0911", scene.file)
        .says("align: sensors are aligned to one true input")
        .got("{} inputs", instants.info().input_names.size())
        .hint("one scene per axis; cross: [CHANNEL, …] names the other axes of each device");
  const Eigen::MatrixXd h = observations(scene, 1);
  if (h.size() == 0) return Eigen::VectorXd::Ones(static_cast<Eigen::Index>(scene.sensors.size()));
  return h.col(0);
}

fusion::AlignmentOptions options_of(const Scene& scene) {
  const SceneAlign& align = *scene.align;
  const auto has = [&](std::string_view term) {
    return std::find(align.terms.begin(), align.terms.end(), term) != align.terms.end();
  };
  fusion::AlignmentOptions out;
  if (align.terms.empty()) {
    out.bias = !scene.rest;  // an offset at rest is known better than one in motion
  } else {
    out = {has("delay"), has("bias"), has("gain"), has("misalignment")};
  }
  if (align.interpolation == "cubic") out.interpolation = fusion::Interpolation::cubic;
  return out;
}

// All of the window, or stretches of it when it is long.
class Gathered {
 public:
  Gathered(LearningWindow window, std::int64_t rows, std::int64_t values = kMostValues) : window_(window) {
    const std::int64_t length = window.to - window.from, most = values / rows;
    stretches_ = length <= most ? 1 : std::clamp<std::int64_t>(most / kShortestStretch, 1, kStretches);
    each_ = std::min(length, most / stretches_);
  }
  void take(std::int64_t first, const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth) {
    for (std::int64_t s = 0; s < stretches_; ++s) {
      const std::int64_t start =
          window_.from + (window_.to - window_.from - each_) * s / std::max<std::int64_t>(1, stretches_ - 1);
      const std::int64_t from = std::max(first, start);
      const std::int64_t to = std::min<std::int64_t>(first + samples.cols(), start + each_);
      if (from >= to) continue;
      if (data.samples.size() == 0) {
        const auto all = static_cast<Eigen::Index>(stretches_ * each_);
        data.samples.resize(samples.rows(), all);
        truths_.resize(truth.rows(), all);
      }
      const auto at = static_cast<Eigen::Index>(s * each_ + from - start);
      const auto of = static_cast<Eigen::Index>(from - first), columns = static_cast<Eigen::Index>(to - from);
      data.samples.middleCols(at, columns) = samples.middleCols(of, columns);
      truths_.middleCols(at, columns) = truth.middleCols(of, columns);
    }
  }
  void finish(bool by_reference) {
    for (std::int64_t s = 0; s < stretches_; ++s) data.starts.push_back(static_cast<Eigen::Index>(s * each_));
    if (by_reference) data.truth = truths_.row(0);
  }
  bool in_part() const { return stretches_ > 1; }
  std::int64_t stretches() const { return stretches_; }
  fusion::AlignmentData data;

 private:
  LearningWindow window_;
  std::int64_t stretches_ = 1, each_ = 0;
  Eigen::MatrixXd truths_;
};

// The window of the alignment, in the unit of the input.
Gathered gather(const Scene& scene, const ReplayPlan& plan, const Instants& instants, std::int64_t values,
                LearningWindow& window, Progress& progress) {
  const Eigen::VectorXd h = weights_of(scene, instants);
  const bool by_reference = instants.info().has_reference && scene.align->by != "sensors";
  window = window_of_alignment(scene, plan, instants);
  const auto axes = static_cast<Eigen::Index>(instants.source().info().further_axes);
  Gathered out(window, h.size() * (1 + axes), values);
  instants.pass_recorded(window.from, window.to, kLearningBlockOfAlignment, progress,
                         [&](const InstantBlock& b) { out.take(b.first, b.samples, b.truth); });
  out.finish(by_reference);
  out.data.channels = h.size();
  if (out.data.samples.size() > 0) out.data.samples.topRows(h.size()).array().colwise() /= h.array();
  return out;
}

}  // namespace

std::vector<AlignmentResult::Trial> choose_scene_terms(Scene& scene, const ReplayPlan& plan, const Instants& instants,
                                                       Progress& progress) {
  SceneAlign& align = *scene.align;
  LearningWindow window;
  const Gathered gathered = gather(scene, plan, instants, kMostTried, window, progress);
  fusion::AlignmentOptions allowed = options_of(scene);
  const TermChoice choice = choose_terms(gathered.data, allowed);
  align.apply = choice.any();
  if (!align.apply) return choice.trials;
  align.terms.clear();
  const bool kept[] = {choice.options.delay, choice.options.bias, choice.options.gain, choice.options.misalignment};
  for (std::size_t k = 0; k < std::size(kept); ++k)
    if (kept[k]) align.terms.emplace_back(kAlignTerms[k]);
  if (choice.options.delay)
    align.interpolation = choice.options.interpolation == fusion::Interpolation::cubic ? "cubic" : "sinc";
  return choice.trials;
}

SceneAlignment learn_scene_alignment(const Scene& scene, const ReplayPlan& plan, const Instants& instants,
                                     Progress& progress) {
  SceneAlignment out;
  out.h = weights_of(scene, instants);
  out.by_reference = instants.info().has_reference && scene.align->by != "sensors";
  LearningWindow window;
  const Gathered gathered = gather(scene, plan, instants, kMostValues, window, progress);
  out.from = window.from;
  out.to = window.to;
  try {
    out.alignment = fusion::learn_alignment(gathered.data, options_of(scene));
  } catch (const Error& error) {
    Problem problem = error.problem();
    problem.where = scene.file;
    throw Error(problem);
  }
  if (gathered.in_part())
    out.alignment.notes.push_back(fmt::format("learnt from {} stretches of the window, {} instants in all",
                                              gathered.stretches(), gathered.data.samples.cols()));
  return out;
}

AlignmentResult measure_alignment(const Scene& scene, const ReplayPlan& plan, const Instants& instants,
                                  const SceneAlignment& alignment, Findings& warnings, Progress& progress) {
  AlignmentResult out;
  out.learnt = alignment.alignment;
  out.by_reference = alignment.by_reference;
  out.applied = scene.align->apply;
  const auto at = [&](std::int64_t instant) {
    return instants.info().start_s + static_cast<double>(instant) / instants.info().rate_hz;
  };
  out.window = {at(alignment.from), at(alignment.to)};
  out.overlaps = alignment.from < plan.run_to && alignment.to > plan.run_from;
  if (out.overlaps)
    warnings.add("alignment_in_evaluation",
                 "the alignment is learnt and judged on the same stretch: it looks better than it is", "");
  std::vector<Eigen::Index> used;
  for (std::size_t i = 0; i < out.learnt.channels.size(); ++i)
    if (out.learnt.channels[i].used) {
      used.push_back(static_cast<Eigen::Index>(i));
      out.budgeted.push_back(i);
    }
  const auto n = static_cast<Eigen::Index>(used.size());
  const auto axes = static_cast<Eigen::Index>(instants.source().info().further_axes);
  fusion::BudgetMeter meter(n, axes, plan.run_to - plan.run_from, out.by_reference);
  Eigen::VectorXd cross;
  each_aligned(instants, alignment, plan.run_from, plan.run_to, progress, [&](const AlignedSamples& one) {
    fusion::cross_means(out.learnt, one.recorded, cross);
    const Eigen::VectorXd undelayed = fusion::in_time(out.learnt, one.aligned, cross);
    meter.push(one.recorded(used), undelayed(used), one.aligned(used), cross,
               one.truth.size() > 0 ? one.truth(0) : kNone);
  });
  out.budget = meter.result();
  return out;
}

}  // namespace libchar
