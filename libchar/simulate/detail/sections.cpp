// The inner loop of the flicker filter. Sections are taken seven vectors (28 sections) at a time
// over a block of samples, so that states stay in registers and the latency of one section hides
// behind the others; what the passes contribute to each sample is added in a fixed order.

#include "libchar/simulate/detail/sections.hpp"

#include <algorithm>
#include <array>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar {
namespace {

constexpr std::size_t kSectionBlock = 256;
constexpr std::size_t kMostVectors = 7;

/// V vectors of sections over a block: their sum is put into (First) or added to `sums`.
template <std::size_t V, bool First>
inline __attribute__((always_inline)) void pass(const double* loss,
                                                const double* weight,
                                                double* state,
                                                const double* values,
                                                Four* sums,
                                                std::size_t count) {
  Four x[V], q[V], w[V];
  for (std::size_t v = 0; v < V; ++v) {
    x[v] = LIBCHAR_FOUR(state + 4 * v);
    q[v] = LIBCHAR_FOUR(loss + 4 * v);
    w[v] = LIBCHAR_FOUR(weight + 4 * v);
  }
  for (std::size_t t = 0; t < count; ++t) {
    const double value = values[t];
    const Four g = {value, value, value, value};
#pragma GCC unroll 8
    for (std::size_t v = 0; v < V; ++v) x[v] += w[v] * g - q[v] * x[v];
    Four sum = x[0];
#pragma GCC unroll 8
    for (std::size_t v = 1; v < V; ++v) sum += x[v];
    if constexpr (First)
      sums[t] = sum;
    else
      sums[t] += sum;
  }
  for (std::size_t v = 0; v < V; ++v) LIBCHAR_FOUR_TO(state + 4 * v) = x[v];
}

template <bool First>
inline __attribute__((always_inline)) void pass_of(std::size_t vectors,
                                                   const double* loss,
                                                   const double* weight,
                                                   double* state,
                                                   const double* values,
                                                   Four* sums,
                                                   std::size_t count) {
  switch (vectors) {
    case 1:
      return pass<1, First>(loss, weight, state, values, sums, count);
    case 2:
      return pass<2, First>(loss, weight, state, values, sums, count);
    case 3:
      return pass<3, First>(loss, weight, state, values, sums, count);
    case 4:
      return pass<4, First>(loss, weight, state, values, sums, count);
    case 5:
      return pass<5, First>(loss, weight, state, values, sums, count);
    case 6:
      return pass<6, First>(loss, weight, state, values, sums, count);
    default:
      return pass<7, First>(loss, weight, state, values, sums, count);
  }
}

LIBCHAR_WIDE_LANES void run_block(const double* loss,
                                  const double* weight,
                                  double* state,
                                  std::size_t vectors,
                                  double level,
                                  double* values,
                                  std::size_t count) {
  std::array<Four, kSectionBlock> sums;
  std::size_t passes = (vectors + kMostVectors - 1) / kMostVectors, done = 0;
  for (bool first = true; done < vectors; first = false, --passes) {
    const std::size_t now = (vectors - done) / passes;
    const std::size_t at = 4 * done;
    if (first)
      pass_of<true>(now, loss + at, weight + at, state + at, values, sums.data(), count);
    else
      pass_of<false>(now, loss + at, weight + at, state + at, values, sums.data(), count);
    done += now;
  }
  for (std::size_t t = 0; t < count; ++t)
    values[t] = ((sums[t][0] + sums[t][1]) + (sums[t][2] + sums[t][3])) - level;
}

}  // namespace

void run_sections(const Sections& sections, double level, std::span<double> values) {
  for (std::size_t t = 0; t < values.size(); t += kSectionBlock)
    run_block(sections.loss,
              sections.weight,
              sections.state,
              sections.vectors,
              level,
              values.data() + t,
              std::min(kSectionBlock, values.size() - t));
}

}  // namespace libchar
