// An algorithm of one's own under the contract of fusion/algorithm.hpp: the midrange of the sensors.
#include <algorithm>
#include <cstdio>

#include "libchar/fusion/runner.hpp"

namespace fusion = libchar::fusion;

struct Midrange {
  static constexpr fusion::Description description{.name = "midrange",
                                                   .title = "Middle between the smallest and the largest",
                                                   .source = "this page",
                                                   .complexity = "O(n)"};
  explicit Midrange(const fusion::Array&) {}
  fusion::Estimate step(const fusion::Sample& y) const {
    return fusion::Estimate::scalar((y.minCoeff() + y.maxCoeff()) / 2, 0);
  }
};

int main() {
  fusion::Array array;
  array.channels = 3;
  // Checks the contract when compiled.
  fusion::RunnerOf<Midrange> runner(array, fusion::Settings());
  Eigen::MatrixXd samples(3, 2), x(1, 2), variance(1, 2);
  samples << 1.0, 2.0,  // one row per sensor, one column per instant
      1.2, 2.2, 1.1, 2.6;
  runner.run(samples, x, variance);
  std::printf("%.2f %.2f\n", x(0, 0), x(0, 1));
}
