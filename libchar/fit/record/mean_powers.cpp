#include "libchar/fit/record/mean_powers.hpp"

#include "libchar/fit/detail/record/record_powers.hpp"

namespace libchar {

void join(MeanPowers& powers, const MeanPowers& later) {
  join(powers.blocks, later.blocks);
  for (std::size_t piece = 0; piece < powers.pieces.size(); ++piece)
    join(powers.pieces[piece], later.pieces[piece]);
}

void write_state(const MeanPowers& powers, StateWriter& to) {
  write_state(powers.blocks, to);
  for (const PooledSums& piece : powers.pieces) write_state(piece, to);
}

MeanPowers read_mean_powers(std::uint64_t per_mean, std::uint64_t block, StateReader& from) {
  MeanPowers powers;
  powers.blocks = read_pooled_sums(end_of_left(kMeansBlock, per_mean, block), from);
  for (std::size_t piece = 0; piece < powers.pieces.size(); ++piece)
    powers.pieces[piece] =
        read_pooled_sums(end_of_left(MeanPowers::piece_length(piece), per_mean, block), from);
  return powers;
}

}  // namespace libchar
