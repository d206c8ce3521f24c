#include <cstdio>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"

int main() {
  const std::vector<double> ramp = {0, 1, 2, 3, 4, 5, 6, 7};
  const libchar::AllanCurve curve = libchar::allan_deviation(ramp, 1.0);
  std::printf("%.6f\n", curve.points.at(0).deviation);  // a ramp of slope 1: tau / sqrt 2
}
