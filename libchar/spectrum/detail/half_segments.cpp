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
// Each transform of h = n1 n2 values goes in two steps that stay in the cache (W. M.
// Gentleman and G. Sande, 1966; D. H. Bailey, 1990): over t1 at fixed t2, a turn by exp(-2 pi i t2
// m1 / h), over t2; t = n2 t1 + t2, m = m1 + n1 m2. The result is left where it stands, in rows of
// fixed m1: the mirror of row r is row n1 - r (odd bins: n1 - 1 - r) backwards, the neighbours m ±
// 1 are the rows beside it, and everything after the transform goes row by row, from both ends to
// the middle, as soon as a row is there: memory is what this costs, more than arithmetic.
//
// Only m2 < n2/2 is kept: the rest is the mirror. Inside a row of bins four values stand as four
// real and four imaginary parts, in the order 0 2 1 3 that unpacking gives.

#include "libchar/spectrum/detail/half_segments.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libchar/spectrum/detail/half_rows.hpp"

namespace libchar {

using namespace half_segments;

namespace {

constexpr std::size_t kShortest = 1U << 11U;  // halves below are transformed faster whole

inline void prefetch(const double* values, std::size_t n) {
  for (std::size_t i = 0; i < n; i += 8) __builtin_prefetch(values + i, 1, 2);
}

}  // namespace

class HalfSegments::Sums {
 public:
  explicit Sums(std::size_t h) : values(aligned_zeros(h)) {}
  AlignedDoubles values;  // even bins, then odd bins
  double top = 0;         // bin h
};

void HalfSegments::SumsFreed::operator()(Sums* sums) const {
  delete sums;
}

struct HalfSegments::State {
  std::shared_ptr<RowPool> pool;
  AlignedDoubles z;           // of the half before: even bins, then odd bins
  double z_top = 0;           // its bin h
  AlignedDoubles block_sums;  // even bins, then odd bins; when first asked for
  AlignedDoubles nothing;     // a half that is not there; when first needed
  bool joined = false;        // z is there
  double before_mean = 0;

  State(std::size_t half, RowPools* pools)
      : pool(pools != nullptr ? pools->of(half) : std::make_shared<RowPool>(half)),
        z(aligned_zeros(2 * half)) {}
  const double* samples_of(const Half& half);
  Used push(Half a, Half b, Sums* first, Sums* second, bool remember);
  void natural(const double* sums, double top, std::vector<double>& out) const;
};

namespace {

// One pass over the rows of a pair.
class Pass {
 public:
  struct Work {
    HalfPair pair;
    double before_mean;
    double* z;
    double *z_top, *block_sums;
    bool remember;
    double weight_a, weight_b;
    // Places of the sums of the two segments and their bins h; none: not wanted.
    double *first, *second, *first_top, *second_top;
  };

  Pass(const RowTables& tables, RowScratch& scratch, const Work& work)
      : t_(tables), scratch_(scratch), work_(work), bins_(tables.n2 / 2) {}
  void run();

 private:
  /// X of a row of both segments.
  struct Row {
    double* x = nullptr;
  };
  std::size_t place(std::size_t r, bool odd) const { return (odd ? t_.h / 2 : 0) + r * bins_; }
  void make(std::size_t r, bool odd, Row to, Row to_mirror);
  void make_row(std::size_t r, bool odd, const double* values, const double* mirror, Row to);
  void window(std::size_t r, bool odd, Row low, Row centre, Row high);
  void window_first_row(Row below, Row even, Row odd);
  void ask_for(std::size_t r, bool odd) const;
  void ask_for_step(std::size_t r) const;
  Row moved_up(Row even_first);

  const RowTables& t_;
  RowScratch& scratch_;
  const Work& work_;
  std::size_t bins_;
  double first_top_ = 0, second_top_ = 0;
};

/// A row and its mirror row, which is made of the same two; the first even row and the middle ones
/// are their own.
void Pass::make(std::size_t r, bool odd, Row to, Row to_mirror) {
  const std::size_t mirror = r == 0 && !odd ? 0 : t_.n1 - (odd ? 1 : 0) - r;
  const double* const values = scratch_.row(r, odd, 0);
  if (mirror != r) {
    const double* const mirrored = scratch_.row(mirror, odd, 1);
    make_row(r, odd, values, mirrored, to);
    return make_row(mirror, odd, mirrored, values, to_mirror);
  }
  if (r > 0 || odd) return make_row(r, odd, values, values, to);
  make_row(r, odd, values, scratch_.mirror_of(values), to);
  // Bin h is its own mirror.
  const double* const middle = values + t_.n2;
  first_top_ = *work_.z_top + middle[0];
  second_top_ = middle[0] + middle[1];
  if (work_.remember) *work_.z_top = middle[1];
}

void Pass::make_row(std::size_t r, bool odd, const double* values, const double* mirror, Row to) {
  const std::size_t at = 2 * place(r, odd);
  const BinRow row{values,
                   mirror,
                   bins_,
                   t_.quarter.data(),
                   t_.start_of(r, odd),
                   work_.z + at,
                   work_.remember ? work_.z + at : scratch_.spare(0),
                   to.x,
                   to.x + scratch_.second(),
                   work_.before_mean - work_.pair.mean_a,
                   work_.pair.mean_a - work_.pair.mean_b,
                   work_.block_sums == nullptr ? nullptr : work_.block_sums + at / 2,
                   work_.weight_a,
                   work_.weight_b};
  odd ? odd_bins(row) : even_bins(row);
}

void Pass::window(std::size_t r, bool odd, Row low, Row centre, Row high) {
  const std::size_t at = place(r, odd), next = scratch_.second();
  const Neighbours x{low.x, centre.x, high.x};
  const Neighbours y{low.x + next, centre.x + next, high.x + next};
  if (work_.first != nullptr && work_.first == work_.second)
    return add_windowed(x, y, bins_, work_.first + at);
  if (work_.first != nullptr) add_windowed(x, bins_, work_.first + at);
  if (work_.second != nullptr) add_windowed(y, bins_, work_.second + at);
}

/// Below the first row stands the last one, moved by one; below bin 1 its conjugate.
void Pass::window_first_row(Row last_odd, Row even, Row odd) {
  const Row below{scratch_.spare(0)};
  for (const std::size_t segment : {std::size_t{0}, scratch_.second()}) {
    for (std::size_t m2 = bins_ - 1; m2 > 0; --m2)
      put(below.x + segment, m2, value_at(last_odd.x + segment, m2 - 1));
    put(below.x + segment, 0, std::conj(value_at(odd.x + segment, 0)));
  }
  window(0, false, below, even, odd);
  // Both neighbours of bin h are the last odd bin, or its conjugate.
  const auto add = [&](double* sum, double x_top, const double* row) {
    if (sum == nullptr) return;
    const double y = 0.5 * x_top - 0.5 * value_at(row, bins_ - 1).real();
    *sum += y * y;
  };
  add(work_.first_top, first_top_, last_odd.x);
  add(work_.second_top, second_top_, last_odd.x + scratch_.second());
}

/// Above the last row stands the first one, moved by one; at its end bin h.
Pass::Row Pass::moved_up(Row first) {
  const Row above{scratch_.spare(1)};
  for (const std::size_t segment : {std::size_t{0}, scratch_.second()}) {
    for (std::size_t m2 = 0; m2 + 1 < bins_; ++m2)
      put(above.x + segment, m2, value_at(first.x + segment, m2 + 1));
    put(above.x + segment, bins_ - 1, segment == 0 ? first_top_ : second_top_);
  }
  return above;
}

/// Rows are short and in two orders, too short for the processor to see what comes next: asked for
/// a step ahead, what the next step needs is there.
void Pass::ask_for(std::size_t r, bool odd) const {
  const std::size_t at = place(r, odd);
  prefetch(scratch_.untransformed(r, odd), 2 * t_.n2);
  prefetch(work_.z + 2 * at, t_.n2);
  if (work_.block_sums != nullptr) prefetch(work_.block_sums + at, bins_);
  if (work_.second != nullptr) prefetch(work_.second + at, bins_);
}

void Pass::ask_for_step(std::size_t r) const {
  if (2 * r > t_.n1) return;
  ask_for(r, false);
  if (r > 0) ask_for(t_.n1 - r, false);
  if (2 * r == t_.n1) return;
  ask_for(r, true);
  ask_for(t_.n1 - 1 - r, true);
}

void Pass::run() {
  scratch_.transform_columns(work_.pair);
  // Rows of this step and of the one before: even and odd, rising from the first and falling from
  // the last.
  Row even{scratch_.bins(0)}, even_before{scratch_.bins(1)}, odd{scratch_.bins(2)},
      odd_before{scratch_.bins(3)};
  Row even_falling{scratch_.bins(4)}, even_falling_before{scratch_.bins(5)},
      odd_falling{scratch_.bins(6)}, odd_falling_before{scratch_.bins(7)};
  const std::size_t n1 = t_.n1;
  for (std::size_t r = 0; 2 * r <= n1; ++r) {
    const std::size_t falling = n1 - r;
    ask_for_step(r + 1);
    make(r, false, even, even_falling);
    if (2 * r < n1) make(r, true, odd, odd_falling);
    if (r == 0) {
      window_first_row(odd_falling, even, odd);
      even_falling = std::exchange(even_falling_before, moved_up(even));
    } else {
      window(r - 1, true, even_before, odd_before, even);
      if (falling == r) {  // the middle row closes both ways
        window(r, false, odd_before, even, odd_falling_before);
        window(r, true, even, odd_falling_before, even_falling_before);
      } else {
        const bool closes = 2 * r + 1 == n1;
        window(r, false, odd_before, even, odd);
        window(falling, false, closes ? odd : odd_falling, even_falling, odd_falling_before);
        window(falling, true, even_falling, odd_falling_before, even_falling_before);
        if (closes) window(r, true, even, odd, even_falling);
      }
      std::swap(even_falling, even_falling_before);
    }
    std::swap(even, even_before);
    std::swap(odd, odd_before);
    std::swap(odd_falling, odd_falling_before);
  }
}

}  // namespace

/// Zeros for a half that is not there or not whole: its partner has nothing to do with it.
const double* HalfSegments::State::samples_of(const Half& half) {
  if (half.samples != nullptr && std::isfinite(half.mean)) return half.samples;
  if (!nothing) nothing = aligned_zeros(pool->tables.h);
  return nothing.get();
}

HalfSegments::Used HalfSegments::State::push(
    Half a, Half b, Sums* first, Sums* second, bool remember) {
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
    const Pass::Work work{{samples_a, samples_b, a_whole ? a.mean : 0, b_whole ? b.mean : 0},
                          before_mean,
                          z.get(),
                          &z_top,
                          block_a || block_b ? block_sums.get() : nullptr,
                          remember,
                          block_a ? 1.0 : 0.0,
                          block_b ? 1.0 : 0.0,
                          first == nullptr ? nullptr : first->values.get(),
                          second == nullptr ? nullptr : second->values.get(),
                          first == nullptr ? nullptr : &first->top,
                          second == nullptr ? nullptr : &second->top};
    Pass(pool->tables, *scratch, work).run();
    pool->give_back(std::move(scratch));
  }
  if (remember) {
    joined = b_whole;
    before_mean = b.mean;
  }
  return used;
}

void HalfSegments::State::natural(const double* sums, double top, std::vector<double>& out) const {
  const RowTables& t = pool->tables;
  const std::size_t bins = t.n2 / 2;
  out.resize(t.h + 1);
  for (std::size_t r = 0; r < t.n1; ++r)
    for (std::size_t m2 = 0; m2 < bins; ++m2) {
      const std::size_t place = r * bins + sum_place(m2), m = r + t.n1 * m2;
      out[2 * m] = sums[place];
      out[2 * m + 1] = sums[t.h / 2 + place];
    }
  out[t.h] = top;
}

bool HalfSegments::suits(const WelchOptions& options) {
  const std::uint64_t h = options.segment / 2;
  return options.window == Window::hann && options.overlap == 0.5 &&
         options.detrend == Detrend::constant && options.segment % 2 == 0 && h >= kShortest &&
         rows_and_columns(h).first != 0;
}

HalfSegments::HalfSegments(std::size_t segment, RowPools* pools)
    : state_(std::make_unique<State>(segment / 2, pools)) {}
HalfSegments::~HalfSegments() = default;
HalfSegments::HalfSegments(HalfSegments&&) noexcept = default;
HalfSegments& HalfSegments::operator=(HalfSegments&&) noexcept = default;

std::size_t HalfSegments::half() const {
  return state_->pool->tables.h;
}

HalfSegments::Half HalfSegments::half_at(const double* samples, bool block) const {
  return {samples, mean_about_first(samples, half()), block};
}

HalfSegments::SumsPointer HalfSegments::zero_sums() const {
  return SumsPointer(new Sums(half()));
}

HalfSegments::SumsPointer HalfSegments::copy_of(const Sums& sums) const {
  SumsPointer copy = zero_sums();
  std::copy_n(sums.values.get(), half(), copy->values.get());
  copy->top = sums.top;
  return copy;
}

void HalfSegments::take_power(Sums& sums, std::vector<double>& power) const {
  state_->natural(sums.values.get(), sums.top, power);
  std::fill_n(sums.values.get(), half(), 0.0);
  sums.top = 0;
}

HalfSegments::Used HalfSegments::push(const Half& a, const Half& b, Sums* first, Sums* second) {
  return state_->push(a, b, first, second, true);
}

bool HalfSegments::add_last(const Half& a, Sums& sums) const {
  return state_->push({a.samples, a.mean, false}, {}, &sums, nullptr, false).first;
}

void HalfSegments::forget() {
  state_->joined = false;
}

std::vector<double> HalfSegments::block_power() const {
  const State& s = *state_;
  const std::size_t h = half();
  std::vector<double> power(h, 0.0);
  if (!s.block_sums) return power;
  s.natural(s.block_sums.get(), 0, power);
  power.resize(h);
  for (double& c : power) c *= 2 / static_cast<double>(h);
  return power;
}

}  // namespace libchar
