#pragma once
// The stretches of a series that are nearest to a given one: for a query q of d values, the M
// starts s with the smallest cityblock distances
//   D_s = sum_j |z_{s+j} - q_j|
// among those whose d values and successor z_{s+d} are all there. The search is exact: all distances (vectorised over
// s), then one pass that keeps the M best in order: those within a limit that is known from the smallest distances of 3
// M classes of starts. Equal distances go by the smaller start. A thousand stretches of six values fit the first cache;
// a tree would not pay (m = 1000, d = 6: SciPy's k-d tree 20 us, all distances 13 us).

#include <span>
#include <vector>

namespace libchar::fusion {

struct Neighbour {
  double distance;
  std::ptrdiff_t start;
};

class DelaySearch {
 public:
  /// Room for `most` starts and `neighbours` results: `nearest` makes no trip to the heap.
  DelaySearch(std::size_t dimension, std::size_t neighbours, std::size_t most);
  /// Nearest first; fewer than M when fewer stretches are complete. NaN in the series marks a value
  /// that is not there. `series` holds starts + dimension values.
  std::span<const Neighbour> nearest(const double* series, std::size_t starts, const double* query);
  std::size_t dimension() const { return dimension_; }

 private:
  std::size_t take_within(double limit, std::size_t starts);
  void sort_by_distance(std::size_t count);
  void rank_by_distance(std::size_t count);

  std::size_t dimension_, neighbours_;
  std::vector<double> distances_, smallest_, of_class_;  // of a start, a group, a class of them
  std::vector<double> within_distances_;
  std::vector<std::ptrdiff_t> within_;  // starts that may be among the nearest
  std::vector<Neighbour> found_;
};

/// sum_j w_j z_{s_j + d} with w_j in proportion to 1/max(D_j, floor); the floor lets a stretch that
/// fits exactly count for all instead of dividing by zero. NaN when nothing was found.
double prediction(std::span<const Neighbour> found, const double* series, std::size_t dimension);

}  // namespace libchar::fusion
