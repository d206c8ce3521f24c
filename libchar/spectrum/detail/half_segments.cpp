// Welch's method with a Hann window and half-overlapping segments, without transforming any sample
// twice over a whole segment.
//
// With h samples in a half, L = 2h, and Z_k the DFT at the L frequencies of a half less its mean s
// and padded with zeros, a segment made of the halves p and a, less its own mean (s_p + s_a)/2, has
//   X_k = P_k + (-1)^k A_k + (s_p - s_a) (1 - i cot(pi k / L)) [k odd]
// (the last term is the transform of the step between the means), and with the periodic Hann
// window, three terms of a cosine sum,
//   Y_k = X_k/2 - (X_{k-1} + X_{k+1})/4.
// The same Z_k gives the orthonormal DCT-II of the half:
//   c_k = sqrt(2/h) Re(exp(-i pi k / L) Z_k).
//
// Z itself: even bins k = 2m are the DFT of the half, odd ones k = 2m+1 its DFT at frequencies
// moved by half a bin. Two halves a and b are transformed at once as u = a + i b (R. N. Bracewell,
// The Fourier Transform and Its Applications, on two real transforms in one):
//   A_m = (U_m + conj U_m')/2,   B_m = (U_m - conj U_m')/(2i),
//   m' = h - m for even bins, h - 1 - m for odd ones.
// Each transform of h = n1 n2 values goes in two steps that stay in the cache (W. M. Gentleman and G. Sande, 1966; D.
// H. Bailey, 1990): over t1 at fixed t2, a turn by exp(-2 pi i t2 m1 / h), over t2; t = n2 t1 + t2, m = m1 + n1 m2. The
// result is left where it stands, in rows of fixed m1: the mirror of row r is row n1 - r (odd bins: n1 - 1 - r)
// backwards, the neighbours m ± 1 are the rows beside it, and everything after the transform goes row by row, from both
// ends to the middle, as soon as a row is there: memory is what this costs, more than arithmetic.
//
// Only m2 < n2/2 is kept: the rest is the mirror. Inside a row of bins four values stand as four
// real and four imaginary parts, in the order 0 2 1 3 that unpacking gives.

#include "libchar/spectrum/detail/half_segments.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/spectrum/detail/half_pass.hpp"
#include "libchar/spectrum/detail/half_rows.hpp"

namespace libchar {

using namespace half_segments;

namespace {

constexpr std::size_t kShortest = 1U << 11U;  // halves below are transformed faster whole

}  // namespace

class HalfSegments::Sums {
 public:
  explicit Sums(std::size_t h) : values(aligned_zeros(h)) {}
  AlignedDoubles values;  // even bins, then odd bins
  double top = 0;         // bin h
};

struct HalfSegments::State {
  std::shared_ptr<RowPool> pool;
  AlignedDoubles z;           // of the half before: even bins, then odd bins
  double z_top = 0;           // its bin h
  AlignedDoubles block_sums;  // even bins, then odd bins; when first asked for
  AlignedDoubles nothing;     // a half that is not there; when first needed
  bool joined = false;        // z is there
  double before_mean = 0;

  State(std::size_t half, RowPools* pools)
      : pool(pools != nullptr ? pools->of(half) : std::make_shared<RowPool>(half)), z(aligned_zeros(2 * half)) {}
  const double* samples_of(const Half& half);
  Used push(Half a, Half b, Sums* first, Sums* second, bool remember);
};

/// Zeros for a half that is not there or not whole: its partner has nothing to do with it.
const double* HalfSegments::State::samples_of(const Half& half) {
  if (half.samples != nullptr && std::isfinite(half.mean)) return half.samples;
  if (!nothing) nothing = aligned_zeros(pool->tables.h);
  return nothing.get();
}

HalfSegments::Used HalfSegments::State::push(Half a, Half b, Sums* first, Sums* second, bool remember) {
  const std::size_t h = pool->tables.h;
  const bool a_whole = a.samples != nullptr && std::isfinite(a.mean);
  const bool b_whole = b.samples != nullptr && std::isfinite(b.mean);
  const Used used{joined && a_whole, a_whole && b_whole};
  if (!used.first) first = nullptr;
  if (!used.second) second = nullptr;
  const bool block_a = a_whole && a.block, block_b = b_whole && b.block;
  if ((block_a || block_b) && !block_sums) block_sums = aligned_zeros(h);
  if (a_whole || b_whole) {
    const double *const samples_a = samples_of(a), *const samples_b = samples_of(b);
    auto scratch = pool->borrow();
    const double mean_a = a_whole ? a.mean : 0, mean_b = b_whole ? b.mean : 0;
    scratch->transform_columns({samples_a, samples_b, mean_a, mean_b});
    const HalfBins bins{z.get(), z.get() + h, pool->tables.n2, pool->tables.n1, nullptr};
    PairWork work{mean_a, mean_b, before_mean, scratch->even(), scratch->odd(), bins, &z_top, bins, &z_top, remember};
    if (block_a || block_b) work.block_sums = block_sums.get();
    work.weight_a = block_a ? 1 : 0;
    work.weight_b = block_b ? 1 : 0;
    if (first != nullptr) {
      work.first = first->values.get();
      work.first_top = &first->top;
    }
    if (second != nullptr) {
      work.second = second->values.get();
      work.second_top = &second->top;
    }
    Pass(pool->tables, scratch->rows(), work).run();
    pool->give_back(std::move(scratch));
  }
  if (remember) {
    joined = b_whole;
    before_mean = b.mean;
  }
  return used;
}

bool HalfSegments::suits(const WelchOptions& options) {
  const std::size_t h = detail::in_memory(options.segment / 2);
  return options.window == Window::hann && options.overlap == 0.5 && options.detrend == Detrend::constant &&
         options.segment % 2 == 0 && h >= kShortest && rows_and_columns(h).first != 0;
}

HalfSegments::HalfSegments(std::size_t segment, RowPools* pools) : state_(detail::hidden<State>(segment / 2, pools)) {}

std::size_t HalfSegments::half() const { return state_->pool->tables.h; }

HalfSegments::Half HalfSegments::half_at(const double* samples, bool block) const {
  return {samples, mean_about_first(samples, half()), block};
}

HalfSegments::SumsPointer HalfSegments::zero_sums() const { return detail::hidden<Sums>(half()); }

HalfSegments::SumsPointer HalfSegments::copy_of(const Sums& sums) const {
  SumsPointer copy = zero_sums();
  std::copy_n(sums.values.get(), half(), copy->values.get());
  copy->top = sums.top;
  return copy;
}

void HalfSegments::take_power(Sums& sums, std::vector<double>& power) const {
  natural_order(state_->pool->tables, sums.values.get(), sums.top, power);
  std::fill_n(sums.values.get(), half(), 0.0);
  sums.top = 0;
}

HalfSegments::Used HalfSegments::push(const Half& a, const Half& b, Sums* first, Sums* second) {
  return state_->push(a, b, first, second, true);
}

bool HalfSegments::add_last(const Half& a, Sums& sums) const {
  return state_->push({a.samples, a.mean, false}, {}, &sums, nullptr, false).first;
}

void HalfSegments::forget() { state_->joined = false; }

std::vector<double> HalfSegments::block_power() const {
  const State& s = *state_;
  const std::size_t h = half();
  std::vector<double> power(h, 0.0);
  if (!s.block_sums) return power;
  natural_order(s.pool->tables, s.block_sums.get(), 0, power);
  power.resize(h);
  for (double& c : power) c *= 2 / static_cast<double>(h);
  return power;
}

}  // namespace libchar
