// Orthonormal DCT-II of n points, with a = pi k / n and s = sqrt(2/n):
//   step at t0       -s sin(a t0) / (2 sin(a/2)), the mean of w + 1 steps from t0 on -s sin(a (t0 + w/2)) sin(a (w+1)/2) /
//                    ((w+1) 2 sin^2(a/2))
//   r^t              s (1 - (-1)^k r^n) (1 - r) cos(a/2) / ((1 - r)^2 + 4 r sin^2(a/2)),   r = exp(-1/tau)
//   t                -s cos(a/2) / (2 sin^2(a/2)) for odd k, 0 for even k
// geometric sums of cosines; the mean of m samples of an exponential is an exponential again.
#include "libchar/fit/detail/events/shapes.hpp"

#include <cmath>
#include <numbers>

#include "libchar/fit/detail/events/turning.hpp"

namespace libchar {
namespace {

using std::numbers::pi;

/// A step within a point is the mean of the steps beside it by its place; a line over w points is the mean of w + 1 steps.
void fill_step(const EventShape& shape, double n, std::vector<double>& column) {
  const double scale = -std::sqrt(2 / n) / 2, whole = std::floor(shape.at),
               within = shape.at - whole;
  const double steps = shape.bridged + 1, middle = whole + 0.5 * shape.bridged;
  Turning half(pi / (2 * n)), place(pi * middle / n), next(pi * (middle + 1) / n);
  Turning wide(pi * steps / (2 * n));
  for (double& value : column) {
    half.next();
    place.next();
    next.next();
    wide.next();
    const double line = shape.bridged > 0 ? wide.sine / (steps * half.sine) : 1;
    value = scale * line * ((1 - within) * place.sine + within * next.sine) / half.sine;
  }
}

void fill_warm_up(double tau, const SeriesGrid& grid, std::vector<double>& column) {
  const double n = static_cast<double>(grid.points), m = static_cast<double>(grid.per_point);
  const double below = -std::expm1(-1 / tau), r = 1 - below, end = std::exp(-n / tau);
  // The first point is a mean over m samples, the size is that of the first sample.
  const double first = below / (m * -std::expm1(-1 / (tau * m)));
  const double scale = std::sqrt(2 / n) * first * below;
  Turning half(pi / (2 * n));
  double parity = -1;
  for (double& value : column) {
    half.next();
    value =
        scale * (1 - parity * end) * half.cosine / (below * below + 4 * r * half.sine * half.sine);
    parity = -parity;
  }
}

void fill_ramp(const SeriesGrid& grid, std::vector<double>& column) {
  const double n = static_cast<double>(grid.points);
  const double samples = n * static_cast<double>(grid.per_point);
  const double scale = -std::sqrt(2 / n) / 2 * static_cast<double>(grid.per_point) / (samples - 1);
  Turning half(pi / (2 * n));
  bool odd = true;
  for (double& value : column) {
    half.next();
    value = odd ? scale * half.cosine / (half.sine * half.sine) : 0;
    odd = !odd;
  }
}

}  // namespace

void fill_column(const EventShape& shape, const SeriesGrid& grid, std::vector<double>& column) {
  switch (shape.kind) {
    case EventKind::step:
      return fill_step(shape, static_cast<double>(grid.points), column);
    case EventKind::warm_up:
      return fill_warm_up(shape.tau, grid, column);
    case EventKind::ramp:
      return fill_ramp(grid, column);
  }
}

}  // namespace libchar
