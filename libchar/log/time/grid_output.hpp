#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libchar/log/detail/row_source.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

/// Samples on their way to the sink: long runs as they stand in a block, others assembled first.
class GridOutput {
 public:
  explicit GridOutput(BlockSink& sink) : sink_(sink) {}
  void begin(const LogInfo& so_far);
  void rows(const RowBlock& block, std::size_t from, std::size_t to);
  void missing(std::uint64_t count);
  void flush();
  std::uint64_t delivered() const { return delivered_; }

 private:
  void deliver(const std::vector<const double*>& channels, std::size_t rows);

  BlockSink& sink_;
  std::vector<std::vector<double>> staging_;
  std::size_t staged_ = 0;
  std::uint64_t delivered_ = 0;
};

}  // namespace libchar
