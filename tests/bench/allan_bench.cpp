// Cost and error of the Allan curves: `allan_bench [log10 of the number of samples, default 8]`. Times are in units of
// memcpy of the same array in the same run; errors against 128-bit fixed point.

#include <fmt/core.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/core/numeric/moments.hpp"
#include "tests/support/kernels.hpp"

using namespace libchar;

namespace {

__extension__ typedef __int128 Wide;

double seconds_of(const auto& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Shortest of a few runs: the machine is shared.
double best_of(int runs, const auto& work) {
  double best = 1e300;
  for (int i = 0; i < runs; ++i) best = std::min(best, seconds_of(work));
  return best;
}

/// White noise of sigma 1 by sums of uniform integers (exactly representable at any offset used here).
std::vector<double> white(std::size_t n, double offset, double drift) {
  std::vector<double> y(n);
  std::uint64_t state = 88172645463325252ULL;
  for (std::size_t i = 0; i < n; ++i) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      state ^= state << 13;
      state ^= state >> 7;
      state ^= state << 17;
      sum += static_cast<double>(state >> 11) * 0x1p-53 - 0.5;
    }
    y[i] = offset + 2 * sum + drift * (static_cast<double>(i) / static_cast<double>(n));
  }
  return y;
}

/// Cumulated record in fixed point with steps of 2^-60 (relative to sigma = 1), exact in 128 bits up to 1e11 samples.
std::vector<Wide> exact_phase(const std::vector<double>& y) {
  std::vector<Wide> x(y.size() + 1);
  for (std::size_t i = 0; i < y.size(); ++i)
    x[i + 1] = x[i] + static_cast<Wide>(std::ldexp(static_cast<long double>(y[i]) - y[0], 60));
  return x;
}

double exact_deviation(const std::vector<Wide>& x, std::uint64_t m, std::uint64_t stride) {
  long double sum = 0;
  std::uint64_t terms = 0;
  for (std::uint64_t i = 0; i + 2 * m < x.size(); i += stride, ++terms) {
    const long double d = std::ldexp(static_cast<long double>(x[i + 2 * m] - 2 * x[i + m] + x[i]), -60);
    sum += d * d;
  }
  return static_cast<double>(std::sqrt(sum / (2.0L * static_cast<long double>(terms))) / static_cast<long double>(m));
}

double worst_error(const AllanCurve& curve, const std::vector<Wide>& x) {
  double worst = 0;
  for (const AllanPoint& p : curve.points) {
    if (p.m != 1 && p.m != 32 && p.m != 1024 && p.m != 65536 && p.m != 1048576) continue;
    worst = std::max(worst, std::fabs(p.deviation / exact_deviation(x, p.m, stride_of(curve, p)) - 1));
  }
  return worst;
}

AllanCurve pyramid_of(const std::vector<double>& y) {
  AllanPyramid pyramid;
  pyramid.push(y);
  return pyramid.finish(1);
}

void speed(std::size_t n) {
  const std::vector<double> y = white(n, 9.81, 0);
  const auto copy = std::make_unique_for_overwrite<double[]>(n);
  std::memcpy(copy.get(), y.data(), n * sizeof(double));  // touch the pages first
  const double per = 1e9 / static_cast<double>(n);
  double sink = 0, best_ratio = 1e300;
  const double plain = best_of(5, [&] { std::memcpy(copy.get(), y.data(), n * sizeof(double)); });
  const double pyramid = best_of(3, [&] { sink += pyramid_of(y).points[0].deviation; });
  const double moments = best_of(3, [&] {
    Moments m;
    m.push(y);
    sink += m.variance();
  });
  const double both = best_of(3, [&] {
    AllanPyramid p;
    Moments m;
    for (std::size_t i = 0; i < n; i += 4096) {  // as a streaming reader would: block by block, both in cache
      const auto block = std::span(y).subspan(i, std::min<std::size_t>(4096, n - i));
      p.push(block);
      m.push(block);
    }
    sink += p.finish(1).points[0].deviation + m.variance();
  });
  best_ratio = both / plain;
  fmt::print("samples                    {}\n", n);
  fmt::print("memcpy                     {:8.3f} ns/sample\n", plain * per);
  fmt::print("pyramid, all octaves       {:8.3f} ns/sample  {:6.2f} x memcpy\n", pyramid * per, pyramid / plain);
  fmt::print("moments                    {:8.3f} ns/sample  {:6.2f} x memcpy\n", moments * per, moments / plain);
  fmt::print("pyramid + moments          {:8.3f} ns/sample  {:6.2f} x memcpy   (floor 5, aim 3.3)\n", both * per,
             best_ratio);
  std::fflush(stdout);
  if (n > 20000000) return;
  for (const DeviationType type :
       {DeviationType::oadev, DeviationType::mdev, DeviationType::ohdev, DeviationType::totdev}) {
    AllanOptions options;
    options.type = type;
    const double one = best_of(1, [&] {
      options.threads = 1;
      sink += allan_deviation(y, 1, options).points[0].deviation;
    });
    const double all = best_of(1, [&] {
      options.threads = 0;
      sink += allan_deviation(y, 1, options).points[0].deviation;
    });
    fmt::print("full overlap, {:6}       {:8.2f} ns/sample  {:6.1f} x memcpy, one thread; {:.1f} x, all\n",
               name_of(type), one * per, one / plain, all / plain);
  }
  fmt::print("(checksum {})\n", sink);
}

void errors() {
  const std::size_t n = 10000000;
  fmt::print(
      "\nlargest relative error of the deviation at m = 1, 32, 1024, 65536, 1048576; N = {}, 128-bit fixed-point "
      "reference\n",
      n);
  fmt::print("{:34} {:>10} {:>12}\n", "record (sigma 1)", "pyramid", "full overlap");
  const auto row = [&](const char* name, double offset, double drift) {
    const auto y = white(n, offset, drift);
    const auto x = exact_phase(y);
    fmt::print("{:34} {:10.1e} {:12.1e}\n", name, worst_error(pyramid_of(y), x), worst_error(allan_deviation(y, 1), x));
    std::fflush(stdout);
  };
  row("no offset", 0, 0);
  row("offset 9.81e3", 9.81e3, 0);
  row("offset 987654321.123456 (1e9)", 987654321.123456, 0);
  row("drift 1e6 over the record", 0, 1e6);
  row("drift 1e6 and offset 1e9", 987654321.123456, 1e6);
}

void covariance_cost() {
  fmt::print("\ncovariance of the octaves and degrees of freedom, cost independent of the record\n");
  for (const double n : {2e5, 1e8, 1e10}) {
    AllanCurve curve;
    curve.samples = static_cast<std::uint64_t>(n);
    curve.stride_divisor = 4;
    for (std::uint64_t m = 1; 2 * m <= curve.samples; m *= 2) {
      AllanPoint p;
      p.m = m;
      p.tau_s = static_cast<double>(m);
      p.terms = (curve.samples - 2 * m) / std::max<std::uint64_t>(1, m / 4) + 1;
      p.deviation = 1;
      curve.points.push_back(p);
    }
    const Mixture theta = {1, 1e-4, 1e-8, 0, 0};
    double trace = 0;
    const double first = best_of(3, [&] { trace += allan_covariance(curve, theta).trace(); });
    const AllanCovariance prepared(curve);
    const double again = best_of(3, [&] { trace += prepared.at(theta).trace(); });
    const double intervals = best_of(3, [&] { add_intervals(curve, theta); });
    fmt::print(
        "N = {:5.0e}  {} octaves: covariance {:6.2f} ms, again for another mixture {:.4f} ms; edf and intervals {:.2f} "
        "ms\n",
        n, curve.points.size(), first * 1e3, again * 1e3, intervals * 1e3);
  }
}

}  // namespace

int main(int count, char** arguments) {
  const double exponent = count > 1 ? std::stod(arguments[1]) : 8;
  speed(static_cast<std::size_t>(std::llround(std::pow(10, exponent))));
  if (exponent > 7.4) speed(10000000);
  errors();
  covariance_cost();
  test::print_kernels("allan");
  return 0;
}
