#pragma once
// Scores of an algorithm where there is no reference.
//   leave-one-out   e_i = h_i x(without sensor i) - y_i        (the sensor's own noise is in it;
//                   of more than 32 sensors 32 are left out in turn, evenly chosen)
//   split array     e   = (x(even sensors) - x(odd sensors)) / 2: with equal halves of independent
//                   errors its RMS is that of the whole array's estimate
// What all sensors have in common (an error of the board, of the temperature) is in neither.

#include <memory>
#include <vector>

#include "libchar/fusion/runner.hpp"
#include "libchar/replay/detail/plan.hpp"

namespace libchar {

class BlindRun {
 public:
  /// `live`: the sensors that have samples; empty: all.
  BlindRun(const PlannedAlgorithm& planned,
           const fusion::Array& array,
           const std::vector<Eigen::Index>& live);
  /// The first `skip` instants of the block are not scored.
  void run(const Eigen::MatrixXd& samples, Eigen::Index skip);
  BlindScore result(double rate_hz, const ScoreOptions& options) const;
  /// Leave-one-out errors of the sensors that were left out, one meter each: by these methods are compared.
  Meters meters() const;
  std::uint64_t steps() const { return steps_; }

 private:
  struct Part {
    std::vector<Eigen::Index> channels;
    std::unique_ptr<fusion::Runner> runner;  // none: cannot run on these channels
    Eigen::MatrixXd samples, x, variance;
  };
  Part part(const std::vector<Eigen::Index>& channels) const;
  bool step(Part& part, const Eigen::MatrixXd& samples);

  const PlannedAlgorithm* planned_;
  const fusion::Array* array_;
  Eigen::MatrixXd h_;
  std::vector<Part> others_;  // without sensor i
  std::vector<Part> halves_;
  std::vector<ErrorMeter> meters_;
  ErrorMeter all_, split_;
  std::vector<double> errors_, squares_, counts_;
  std::uint64_t steps_ = 0;
};

}  // namespace libchar
