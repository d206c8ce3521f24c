#include "libchar/fit/record/pooled_sums.hpp"

namespace libchar {

void add_squares(std::span<const double> coefficients, PooledSums& sums) {
  sums.power.resize(coefficients.size());
  for (std::size_t k = 1; k < coefficients.size(); ++k)
    sums.power[k] += coefficients[k] * coefficients[k];
  ++sums.transforms;
}

void join(PooledSums& sums, const PooledSums& later) {
  if (sums.power.empty()) sums.power.resize(later.power.size());
  for (std::size_t k = 0; k < later.power.size(); ++k) sums.power[k] += later.power[k];
  sums.transforms += later.transforms;
}

void write_state(const PooledSums& sums, StateWriter& to) {
  to.number(sums.transforms);
  to.reals(sums.power);
}

PooledSums read_pooled_sums(std::uint64_t kept, StateReader& from) {
  PooledSums sums;
  sums.transforms = from.number();
  sums.power = from.reals();
  if (sums.power.size() != kept && (!sums.power.empty() || sums.transforms > 0))
    from.refuse("the powers of its transforms");
  return sums;
}

}  // namespace libchar
