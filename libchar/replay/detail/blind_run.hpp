#pragma once
// Scores of an algorithm where there is no reference.
//   leave-one-out   e_i = h_i x(without sensor i) - y_i        (the sensor's own noise is in it;
//                   of more than 32 sensors 32 are left out in turn, evenly chosen, fewer of more than 128)
//   split array     e   = (x(even sensors) - x(odd sensors)) / 2: with equal halves of independent
//                   errors its RMS is that of the whole array's estimate
// Beyond its budget (blind_share.hpp) it runs on stretches of the run, one after the other, and there are no errors in
// between. What all sensors have in common (an error of the board, of the temperature) is in neither.

#include <memory>
#include <vector>

#include "libchar/fusion/runner.hpp"
#include "libchar/replay/detail/plan/plan.hpp"

namespace libchar {

class BlindRun {
 public:
  /// `live`: the sensors that have samples; empty: all.
  BlindRun(const PlannedAlgorithm& planned, const fusion::Array& array, const std::vector<Eigen::Index>& live);
  /// Where the method looks at the run before it estimates: a block of it, then the end.
  void look(std::int64_t first, const Eigen::MatrixXd& samples);
  void finish_looking();
  bool looks_ahead() const;
  /// The next block, from instant `first` of the run on; its first `skip` instants are not scored.
  void run(std::int64_t first, const Eigen::MatrixXd& samples, Eigen::Index skip);
  BlindScore result(double rate_hz, const ScoreOptions& options) const;
  /// Leave-one-out errors of the sensors that were left out, one meter each: by these methods are compared.
  Meters meters() const;
  std::uint64_t steps() const { return steps_; }

 private:
  struct Part {
    std::vector<Eigen::Index> channels;
    std::unique_ptr<fusion::Runner> runner;  // none: cannot run on these channels
  };
  struct Columns {
    Eigen::Index from = 0, count = 0;
  };
  Part part(const std::vector<Eigen::Index>& channels) const;
  void find_columns(std::int64_t first, Eigen::Index count);
  template <class Work>
  void for_each_part(const Work& work);
  bool step(Part& part, const Eigen::MatrixXd& samples, Eigen::MatrixXd& x);
  void score_others(const Eigen::MatrixXd& samples, Eigen::Index skip);
  void score_halves(const Eigen::MatrixXd& samples, Eigen::Index skip);
  void push_errors(Eigen::Index skip, ErrorMeter& meter);

  const PlannedAlgorithm* planned_;
  const fusion::Array* array_;
  Eigen::MatrixXd h_;
  std::vector<Part> others_;  // without sensor i
  std::vector<Part> halves_;
  std::vector<ErrorMeter> meters_;
  ErrorMeter all_, split_;
  // One part after the other works in them: with room for each, wide arrays would need megabytes an algorithm.
  Eigen::MatrixXd part_, variance_, x_, other_;
  std::vector<Columns> run_, scored_;  // of the block
  std::vector<double> errors_, squares_, counts_;
  std::uint64_t steps_ = 0;
};

}  // namespace libchar
