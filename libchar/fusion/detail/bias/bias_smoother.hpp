#pragma once
// What the filter of virtual_sensor.hpp would say if it knew what comes after: the fixed-interval smoother
// of Bryson and Frazier (Bierman 1973), which inverts no covariance. With e the residual y - C b before an
// instant's samples correct b, K their gain and M = S^-1 (I - H W), backwards from the last instant, v = 0:
//   x   <- x - W C P v             the estimate of the filter, corrected by all samples that follow
//   v   <- A' (C' M e + (I - K C)' v)
// var x <- var x - W C P A' L A P C' W',  L = Y (I + P Y)^-1, P and L those of the next instant;
// Y, what the samples from there on tell of the biases, is the Riccati equation of the same system run
// backwards (A', information and drive exchanged), taken as often as P is.
// The residuals of the whole run are kept: n + r numbers an instant.

#include <memory>
#include <vector>

#include "libchar/fusion/detail/bias/bias_filter.hpp"

namespace libchar::fusion {

class BiasSmoother {
 public:
  /// `filter`: made for a smoother. `most_bytes`: of what is kept.
  BiasSmoother(std::unique_ptr<BiasFilter> filter, Eigen::Index channels, Eigen::Index inputs, double most_bytes);
  /// One instant of the run after the other. Throws Error(numeric) when they are more than fit.
  void look(const Sample& y);
  /// After the last of them.
  void finish();
  /// Their estimates, in the same order; after the last one the first again.
  Estimate step();
  const BiasFilter& filter() const { return *filter_; }

 private:
  /// What d instants tell of the biases before them.
  struct Later {
    double instants;
    Eigen::MatrixXd information;
  };
  Eigen::Ref<Eigen::VectorXd> kept(std::int64_t instant);
  std::vector<Later> later() const;
  void smooth(std::int64_t instant, bool other);

  std::unique_ptr<BiasFilter> filter_;
  Eigen::Index channels_, inputs_;
  double most_bytes_;
  /// A column an instant: its residual (NaN: no sample) and its estimate; later variance and estimate.
  std::vector<Eigen::MatrixXd> kept_;
  std::int64_t count_ = 0, next_ = 0;
  // On the way back.
  Eigen::MatrixXd variance_;  // A' L A
  Eigen::VectorXd future_, back_, residual_, residual_seen_, gained_variance_;
  std::uint64_t version_ = 0;
};

}  // namespace libchar::fusion
