#include "libchar/fusion/detail/fault/cusum_bank.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/lanes.hpp"

namespace libchar::fusion {
namespace {

struct CusumRow {
  CusumInput input;
  double slope, cost;
};

std::array<CusumRow, CusumBank::kRows> cusum_rows() {
  std::array<CusumRow, CusumBank::kRows> rows;
  std::size_t r = 0;
  for (const CusumInput input : {CusumInput::bias, CusumInput::gain})
    for (const double t : {0.35, 0.7, 1.4, 2.8})
      for (const double sign : {1.0, -1.0}) rows[r++] = {input, sign * t, t * t / 2};
  for (const double k : {1.3, 1.7, 2.6, 5.0}) rows[r++] = {CusumInput::noise, (1 - 1 / (k * k)) / 2, std::log(k)};
  return rows;
}

const std::array<CusumRow, CusumBank::kRows> kCusumRows = cusum_rows();

/// All rows of four sensors: what they saw and their largest sums stay in registers. Rows of both signs of a size share
/// their products: S + (-t z - c) = S - (t z + c) to the last bit.
LIBCHAR_LANES void cusum_rows_step_lanes(double* __restrict sums, double* __restrict top, const double* const* a,
                                         const double* const* b, std::size_t padded) {
  const Four zero = {0, 0, 0, 0};
  for (std::size_t i = 0; i < padded; i += 4) {
    Four largest = zero;
    const CusumRow* row = kCusumRows.data();
    for (int input = 0; input < 2; ++input) {
      const Four evidence = LIBCHAR_FOUR(a[input] + i), against = LIBCHAR_FOUR(b[input] + i);
      for (const CusumRow* const end = row + CusumBank::rows(input); row < end; row += 2) {
        const Four grows = evidence * row->slope, falls = against * row->cost;
        const Four up = LIBCHAR_FOUR(sums) + (grows - falls);
        const Four down = LIBCHAR_FOUR(sums + 4) - (grows + falls);
        const Four high = up > zero ? up : zero, low = down > zero ? down : zero;
        LIBCHAR_FOUR_TO(sums) = high;
        LIBCHAR_FOUR_TO(sums + 4) = low;
        const Four top_of_both = high > low ? high : low;
        largest = top_of_both > largest ? top_of_both : largest;
        sums += 8;
      }
    }
    const Four evidence = LIBCHAR_FOUR(a[2] + i), against = LIBCHAR_FOUR(b[2] + i);
    for (const CusumRow* const end = row + CusumBank::rows(2); row < end; ++row) {
      const Four s = LIBCHAR_FOUR(sums) + (evidence * row->slope - against * row->cost);
      const Four kept = s > zero ? s : zero;
      LIBCHAR_FOUR_TO(sums) = kept;
      largest = kept > largest ? kept : largest;
      sums += 4;
    }
    LIBCHAR_FOUR_TO(top + i) = largest;
  }
}
constexpr InLanes<cusum_rows_step_lanes> cusum_rows_step;

}  // namespace

CusumBank::CusumBank(std::size_t sensors)
    : sensors_(sensors), padded_(padded(sensors)), sums_(padded_ * kRows, 0.0), top_(padded_, 0.0) {}

CusumInput CusumBank::input(std::size_t row) { return kCusumRows[row].input; }

double CusumBank::step(const CusumSample& sample) {
  const double* const evidence[] = {sample.z.data(), sample.uz.data(), sample.zz.data()};
  const double* const against[] = {sample.present.data(), sample.uu.data(), sample.present.data()};
  cusum_rows_step(sums_.data(), top_.data(), evidence, against, padded_);
  double largest = 0;
  for (std::size_t i = 0; i < sensors_; ++i) largest = top_[i] > largest ? top_[i] : largest;
  return largest;
}

CusumInput CusumBank::leading(std::size_t i) const {
  std::size_t best = 0;
  for (std::size_t r = 1; r < kRows; ++r)
    if (sums_[place(r, i)] > sums_[place(best, i)]) best = r;
  return input(best);
}

void CusumBank::reset() {
  std::fill(sums_.begin(), sums_.end(), 0.0);
  std::fill(top_.begin(), top_.end(), 0.0);
}

void CusumBank::reset(std::size_t i) {
  for (std::size_t r = 0; r < kRows; ++r) sums_[place(r, i)] = 0;
  top_[i] = 0;
}

}  // namespace libchar::fusion
