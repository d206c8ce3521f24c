#include "libchar/fit/record/pooled_sums.hpp"

#include "libchar/fit/detail/record/record_powers.hpp"

namespace libchar::detail {

void join(MeanPowers& powers, const MeanPowers& later) {
  join(powers.blocks, later.blocks);
  for (std::size_t piece = 0; piece < powers.pieces.size(); ++piece) join(powers.pieces[piece], later.pieces[piece]);
}

void write_state(const MeanPowers& powers, StateWriter& to) {
  write_state(powers.blocks, to);
  for (const PooledSums& piece : powers.pieces) write_state(piece, to);
}

MeanPowers read_mean_powers(std::uint64_t per_mean, std::uint64_t block, StateReader& from) {
  MeanPowers powers;
  powers.blocks = read_pooled_sums(end_of_left(kMeansBlock, per_mean, block), from);
  for (std::size_t piece = 0; piece < powers.pieces.size(); ++piece)
    powers.pieces[piece] = read_pooled_sums(end_of_left(MeanPowers::piece_length(piece), per_mean, block), from);
  return powers;
}

void add_squares(std::span<const double> coefficients, PooledSums& sums) {
  sums.power.resize(coefficients.size());
  for (std::size_t k = 1; k < coefficients.size(); ++k) sums.power[k] += coefficients[k] * coefficients[k];
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

}  // namespace libchar::detail
