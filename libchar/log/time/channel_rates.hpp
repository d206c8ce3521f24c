#pragma once
// A table without stamps whose channels have rates of their own: each sample gets the stamp that the rate of its
// channel says, and the rows of all channels in the order of these stamps are those of any table of unlike clocks.

#include <memory>
#include <vector>

#include "libchar/log/detail/row_source.hpp"

namespace libchar {

/// `rates_hz` of the channels of `rows`. Where a channel has blanks between its samples, its rows are those of the
/// fastest rate that was stated (`rows_hz`); where it has none, they are its own samples. Throws Error(usage) for a log
/// with stamps, Error(input) for blanks that are not those of the rates.
std::unique_ptr<RowSource> with_rates(std::unique_ptr<RowSource> rows, std::vector<double> rates_hz, double rows_hz);

}  // namespace libchar
