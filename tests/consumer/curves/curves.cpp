#include <cstdio>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/log/read.hpp"
#include "libchar/spectrum/welch.hpp"

int main() {
  const std::vector<double> ramp = {0, 1, 2, 3, 4, 5, 6, 7};
  std::printf("%.6f\n", libchar::allan_deviation(ramp, 1.0).points.at(0).deviation);
  libchar::welch(ramp, 1.0);
  return libchar::read_once("-") ? 0 : 1;
}
