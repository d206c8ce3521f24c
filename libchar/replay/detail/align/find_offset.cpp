// d_k = x_ref,k - sum_i h_i y_i,k / sum_i h_i^2 over the sensors that are there;   offset = mean of d
// Of a tilt d_k = wrapped(angle_ref,k - atan2(x_k, z_k)), about the first of them. The interval is
// that of the mean of at most kMostBatches batch means: what is slower than a batch is all in them.
#include "libchar/replay/detail/align/find_offset.hpp"

#include <fmt/format.h>

#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/fusion/tilt_angle.hpp"
#include "libchar/replay/detail/judge/mean_uncertainty.hpp"
#include "libchar/replay/detail/plan/plan.hpp"

namespace libchar {
namespace {

constexpr std::size_t kOffsetBlock = 4096, kMostBatches = 8192;

// Means of so many consecutive values that there are never too many of them.
class BatchMeans {
 public:
  void push(double value) {
    sum_ += value;
    if (++filled_ < size_) return;
    means_.push_back(sum_ / static_cast<double>(size_));
    sum_ = 0;
    filled_ = 0;
    if (means_.size() < kMostBatches) return;
    for (std::size_t k = 0; 2 * k + 1 < means_.size(); ++k)
      means_[k] = 0.5 * (means_[2 * k] + means_[2 * k + 1]);
    means_.resize(means_.size() / 2);
    size_ *= 2;
  }
  const std::vector<double>& means() const { return means_; }
  /// Of all values, those of an unfinished batch too.
  double mean() const {
    double sum = sum_;
    for (const double m : means_) sum += m * static_cast<double>(size_);
    return sum / static_cast<double>(count());
  }
  std::size_t count() const { return means_.size() * size_ + filled_; }

 private:
  std::vector<double> means_;
  double sum_ = 0;
  std::size_t size_ = 1, filled_ = 0;
};

double sensors_say(const Scene& scene,
                   const Eigen::VectorXd& h,
                   const Eigen::MatrixXd& samples,
                   Eigen::Index k) {
  if (scene.tilt)
    return std::atan2(samples(static_cast<Eigen::Index>(scene.tilt->accelerometer_x), k),
                      samples(static_cast<Eigen::Index>(scene.tilt->accelerometer_z), k));
  double sum = 0, weight = 0;
  for (Eigen::Index i = 0; i < h.size(); ++i)
    if (std::isfinite(samples(i, k))) {
      sum += h[i] * samples(i, k);
      weight += h[i] * h[i];
    }
  return weight > 0 ? sum / weight : kMissing;
}

[[noreturn]] void refuse_offset(const Scene& scene, const std::string& what, std::string hint) {
  throw Error({ErrorKind::input,
               "E0913",
               scene.file,
               "reference.offset: " + what,
               "estimate",
               std::move(hint)});
}

}  // namespace

OffsetEstimate find_reference_offset(const Scene& scene,
                                     const Instants& instants,
                                     std::int64_t from,
                                     std::int64_t to,
                                     Progress& progress) {
  if (instants.info().input_names.size() != 1)
    refuse_offset(scene,
                  fmt::format("there are {} true inputs, and one is needed",
                              instants.info().input_names.size()),
                  "give the offset as a number");
  const Eigen::MatrixXd rows = observations(scene, 1);
  const Eigen::VectorXd h =
      rows.size() == 0 ? Eigen::VectorXd::Ones(static_cast<Eigen::Index>(scene.sensors.size()))
                       : Eigen::VectorXd(rows.col(0));
  BatchMeans differences;
  double origin = kMissing;
  instants.pass(from, to, kOffsetBlock, progress, [&](const InstantBlock& b) {
    for (Eigen::Index k = 0; k < b.samples.cols(); ++k) {
      double d = b.truth(0, k) - sensors_say(scene, h, b.samples, k);
      if (!std::isfinite(d)) continue;
      if (std::isnan(origin)) origin = d;
      d -= origin;
      differences.push(scene.tilt ? fusion::wrapped(d) : d);
    }
  });
  if (differences.count() < 2)
    refuse_offset(scene,
                  "hardly any instant has both reference and sensors",
                  "its stamps, its lag or its gaps put it elsewhere");
  const MeanUncertainty known = mean_uncertainty(differences.means());
  const double offset = origin + differences.mean();
  return {scene.tilt ? fusion::wrapped(offset) : offset, known.reach95, known.long_memory};
}

}  // namespace libchar
