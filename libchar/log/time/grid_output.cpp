#include <algorithm>

#include "libchar/log/time/grid.hpp"

namespace libchar {
namespace {

/// Rows assembled where the grid is irregular: fewer of very many channels.
std::size_t most_staged(std::size_t channels) {
  constexpr std::size_t kRows = 8192, kValues = std::size_t{1} << 21U;
  return std::clamp<std::size_t>(kValues / std::max<std::size_t>(channels, 1), 1, kRows);
}

}  // namespace

void GridOutput::begin(const LogInfo& so_far) {
  staging_.resize(so_far.channels.size());
  sink_.begin(so_far);
}

void GridOutput::rows(const RowBlock& block, std::size_t from, std::size_t to) {
  if (from >= to) return;
  const std::size_t rows = to - from;
  if (rows >= 1024) {
    flush();
    std::vector<const double*> channels;
    for (const auto& column : block.columns) channels.push_back(column.data() + from);
    deliver(channels, rows);
    return;
  }
  for (std::size_t c = 0; c < staging_.size(); ++c) {
    staging_[c].resize(staged_);
    staging_[c].insert(staging_[c].end(), block.columns[c].begin() + static_cast<std::ptrdiff_t>(from),
                       block.columns[c].begin() + static_cast<std::ptrdiff_t>(to));
  }
  staged_ += rows;
  if (staged_ >= most_staged(staging_.size())) flush();
}

void GridOutput::missing(std::uint64_t count) {
  while (count > 0) {
    const std::size_t n = static_cast<std::size_t>(std::min<std::uint64_t>(count, most_staged(staging_.size())));
    staged_ += n;
    for (auto& column : staging_) column.resize(staged_, kMissing);
    if (staged_ >= most_staged(staging_.size())) flush();
    count -= n;
  }
}

void GridOutput::flush() {
  if (staged_ == 0) return;
  std::vector<const double*> channels;
  for (const auto& column : staging_) channels.push_back(column.data());
  deliver(channels, staged_);
  staged_ = 0;
  for (auto& column : staging_) column.clear();
}

void GridOutput::deliver(const std::vector<const double*>& channels, std::size_t rows) {
  sink_.block({delivered_, rows, channels});
  delivered_ += rows;
}

}  // namespace libchar
