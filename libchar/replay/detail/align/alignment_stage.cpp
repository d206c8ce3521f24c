#include "libchar/replay/detail/align/alignment_stage.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fusion/alignment_learning.hpp"
#include "libchar/fusion/budget_meter.hpp"
#include "libchar/replay/detail/align/instants.hpp"
#include "libchar/replay/detail/align/term_choice.hpp"

namespace libchar {
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
        .hint("one scene an axis; cross: [CHANNEL, …] names the other axes of each device");
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
