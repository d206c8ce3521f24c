#include "libchar/replay/detail/align/aligned_pass.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/fusion/alignment_learning.hpp"
#include "libchar/replay/detail/align/instants.hpp"

namespace libchar {
namespace {

constexpr Eigen::Index kAlignedBlock = 2048;

// Keeps as many instants as the interpolation needs on either side of the next one.
class HeldBack {
 public:
  HeldBack(const SceneAlignment& alignment, std::int64_t from, std::int64_t to, std::int64_t count,
           const AlignedInstant& one)
      : alignment_(alignment),
        aligner_(alignment.alignment),
        margin_(fusion::margin_of(alignment.alignment)),
        next_(from),
        to_(to),
        one_(one) {
    // Between its first and its last sample every sensor has a value of its own time.
    last_whole_ = count - 1;
    for (const fusion::ChannelAlignment& channel : alignment.alignment.channels) {
      if (!channel.used) continue;
      first_whole_ = std::max(first_whole_, clamped_whole<std::int64_t>(std::ceil(-channel.delay)));
      last_whole_ = std::min(last_whole_, count - 1 - clamped_whole<std::int64_t>(std::ceil(channel.delay)));
    }
  }

  void take(std::int64_t first, const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth) {
    if (samples_.size() == 0) base_ = first;
    Eigen::MatrixXd fresh = samples;
    fresh.topRows(alignment_.h.size()).array().colwise() /= alignment_.h.array();
    aligner_.clip(fresh);
    const Eigen::Index kept = samples_.cols();
    samples_.conservativeResize(fresh.rows(), kept + fresh.cols());
    samples_.rightCols(fresh.cols()) = fresh;
    truth_.conservativeResize(truth.rows(), kept + truth.cols());
    truth_.rightCols(truth.cols()) = truth;
    give(base_ + samples_.cols() - margin_);
    const auto drop = static_cast<Eigen::Index>(std::max<std::int64_t>(0, next_ - margin_ - base_));
    if (drop == 0) return;
    samples_ = samples_.rightCols(samples_.cols() - drop).eval();
    truth_ = truth_.rightCols(truth_.cols() - drop).eval();
    base_ += drop;
  }
  void finish() { give(base_ + samples_.cols()); }

 private:
  void give(std::int64_t until) {
    for (; next_ < std::min(until, to_); ++next_) {
      const auto at = static_cast<Eigen::Index>(next_ - base_);
      aligner_.column(samples_, at, aligned_);
      // At the ends of the recording only sensors without a delay have samples: no array, no estimate.
      if (next_ < first_whole_ || next_ > last_whole_) aligned_.setConstant(kMissing);
      one_({samples_.col(at), aligned_, truth_.col(at)});
    }
  }

  const SceneAlignment& alignment_;
  fusion::Aligner aligner_;
  std::int64_t margin_, base_ = 0, next_, to_, first_whole_ = 0, last_whole_;
  const AlignedInstant& one_;
  Eigen::MatrixXd samples_, truth_;
  Eigen::VectorXd aligned_;
};

}  // namespace

void each_aligned(const Instants& instants, const SceneAlignment& alignment, std::int64_t from, std::int64_t to,
                  Progress& progress, const AlignedInstant& one) {
  HeldBack held(alignment, from, to, instants.info().count, one);
  const std::int64_t margin = fusion::margin_of(alignment.alignment);
  instants.pass_recorded(std::max<std::int64_t>(0, from - margin), std::min(instants.info().count, to + margin),
                         kAlignedBlock, progress,
                         [&](const InstantBlock& b) { held.take(b.first, b.samples, b.truth); });
  held.finish();
}

void pass_aligned(const Instants& instants, const SceneAlignment& alignment, std::int64_t from, std::int64_t to,
                  std::size_t size, Progress& progress, const InstantsBlock& block) {
  const auto width = static_cast<Eigen::Index>(std::max<std::size_t>(size, 1));
  Eigen::MatrixXd samples(alignment.h.size(), width), truths;
  Eigen::Index filled = 0;
  std::int64_t first = from;
  const auto flush = [&] {
    if (filled == 0) return;
    if (filled == width)
      block({first, samples, truths});
    else
      block({first, samples.leftCols(filled), truths.leftCols(filled)});
    first += filled;
    filled = 0;
  };
  each_aligned(instants, alignment, from, to, progress, [&](const AlignedSamples& one) {
    if (truths.cols() == 0) truths.resize(one.truth.size(), width);
    samples.col(filled) = one.aligned.cwiseProduct(alignment.h);
    truths.col(filled) = one.truth;
    if (++filled == width) flush();
  });
  flush();
}

}  // namespace libchar
