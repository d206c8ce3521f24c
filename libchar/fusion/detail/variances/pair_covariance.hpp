#pragma once
// Means and covariance of channels some of whose samples are missing: of the instants that are complete,
// in which all channels see the same input, so that its power cancels in what is made of them (Welford);
// while these are few, of each pair over the instants that have both: the same until the first sample is missing.

#include <Eigen/Core>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

class PairCovariance {
 public:
  explicit PairCovariance(Eigen::Index channels);
  /// No trip to the heap.
  void add(const Sample& y);
  /// Of the samples: the first usable one. Means and products are about it, so that an offset costs no digits.
  double origin() const { return origin_; }
  /// Instants behind the mean of channel i.
  double instants(Eigen::Index i) const { return by_pairs() ? count_(i, i) : complete_; }
  /// Less the origin.
  double mean(Eigen::Index i) const { return by_pairs() ? pair_mean_(i, i) : mean_[i]; }
  /// Into the lower triangle of `out`; a pair never seen together has covariance zero.
  void covariance(Eigen::MatrixXd& out) const;

 private:
  bool by_pairs() const;
  void add_complete(const Sample& y);
  void begin_pairs();
  void add_pairs(const Sample& y);
  double complete_ = 0, origin_ = 0;
  bool started_ = false;
  bool pairs_ = false;  // some instant was not complete
  Eigen::VectorXd mean_, delta_;
  Eigen::MatrixXd products_;  // of complete instants about the mean, lower triangle
  // (i, j), i >= j: instants and products about the means of the pair; pair_mean_(i, j): of channel i
  // where j is present too.
  Eigen::MatrixXd count_, pair_mean_, pair_products_;
};

}  // namespace libchar::fusion
