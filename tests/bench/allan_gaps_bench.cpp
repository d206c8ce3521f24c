// Missing samples and the Allan deviation: `allan_gaps_bench [records, default 200] [log10 of samples, default 4.2]
// [type, default oadev]`. White, flicker and walk with samples missing at random and in gaps of random length; per
// octave the bias of the deviation against the same records whole (per cent) and the share of 95 % intervals that hold
// the truth, full overlap and one pass.

#include <fmt/core.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <vector>

#include "libchar/allan/allan_deviation.hpp"
#include "libchar/allan/allan_pyramid.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;

namespace {

struct Gaps {
  double share;   ///< of the samples that is missing
  double length;  ///< mean length of a gap; 0: each sample by itself
};

/// Gaps and stretches between them of geometric length.
void punch(std::vector<double>& y, const Gaps& gaps, test::Gaussian& gauss) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  if (gaps.length == 0) {
    for (double& v : y)
      if (gauss.uniform() < gaps.share) v = nan;
    return;
  }
  const double leave = 1 / gaps.length, enter = gaps.share / (1 - gaps.share) / gaps.length;
  bool missing = gauss.uniform() < gaps.share;
  for (double& v : y) {
    if (missing) v = nan;
    missing = gauss.uniform() < (missing ? leave : enter) ? !missing : missing;
  }
}

struct Column {
  double sum = 0, whole = 0;
  int points = 0, held = 0;
};

struct Scene {
  const char* name;
  double q, b, k;
};

void add(const AllanCurve& holed, const AllanCurve& whole, const Mixture& theta, std::vector<Column>& columns) {
  AllanCurve curve = holed;
  add_intervals(curve, theta);
  for (const AllanPoint& p : curve.points) {
    const auto k = static_cast<std::size_t>(std::lround(std::log2(static_cast<double>(p.m))));
    if (columns.size() <= k) columns.resize(k + 1);
    Column& c = columns[k];
    const double full = whole.points[k].deviation;
    const double truth =
        deviation_row(curve.type).is_allan() ? std::sqrt(allan_variance(theta, static_cast<double>(p.m), 1)) : full;
    c.sum += p.deviation * p.deviation;
    c.whole += full * full;
    ++c.points;
    c.held += p.ci95.low <= truth && truth <= p.ci95.high ? 1 : 0;
  }
}

void show(const Scene& scene, const Gaps& gaps, const char* form, const std::vector<Column>& columns) {
  fmt::print("{:8} {:3.0f} % {:5.0f}  {:7}  bias", scene.name, 100 * gaps.share, gaps.length, form);
  for (const Column& c : columns) fmt::print(" {:+5.1f}", 50 * (c.sum / c.whole - 1));
  fmt::print("\n{:30}  cover", "");
  int points = 0, held = 0;
  for (const Column& c : columns) {
    fmt::print(" {:5.1f}", 100.0 * c.held / c.points);
    points += c.points;
    held += c.held;
  }
  fmt::print("  all {:.1f}\n", 100.0 * held / points);
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 200;
  AllanOptions options;
  options.type = argc > 3 ? deviation_type(argv[3]).value_or(options.type) : options.type;
  const bool octaves = options.type == DeviationType::oadev;
  const auto n = static_cast<std::size_t>(std::pow(10, argc > 2 ? std::atof(argv[2]) : 4.2));
  for (const Scene& scene : {Scene{"white", 1, 0, 0}, Scene{"flicker", 0, 1, 0}, Scene{"walk", 0, 0, 1}})
    for (const Gaps& gaps : {Gaps{0, 0}, Gaps{.01, 0}, Gaps{.05, 0}, Gaps{.1, 0}, Gaps{.3, 0}, Gaps{.1, 10},
                             Gaps{.1, 100}, Gaps{.1, 1000}, Gaps{.3, 10}, Gaps{.3, 100}}) {
      test::NoiseSource source(n, 1, 7);
      const Mixture theta = {scene.q * scene.q, scene.b * scene.b, scene.k * scene.k};
      std::vector<Column> exact, streamed;
      for (int r = 0; r < records; ++r) {
        std::vector<double> y = source.record(scene.q, scene.b, scene.k);
        const AllanCurve whole = allan_deviation(y, 1, options), passed = pyramid_deviation(y, 1);
        punch(y, gaps, source.gauss());
        add(allan_deviation(y, 1, options), whole, theta, exact);
        if (octaves) add(pyramid_deviation(y, 1), passed, theta, streamed);
      }
      show(scene, gaps, "overlap", exact);
      if (octaves) show(scene, gaps, "stream", streamed);
    }
}
