#pragma once
// Instants with the sensors aligned: the interpolation looks at instants on either side, so samples
// are held back by as many. The same bits for any size of block.

#include <Eigen/Core>
#include <cstdint>
#include <functional>

#include "libchar/core/process/progress.hpp"
#include "libchar/fusion/aligner.hpp"

namespace libchar {

class Instants;

struct InstantBlock {
  std::int64_t first;              ///< instant
  const Eigen::MatrixXd& samples;  ///< n x m
  const Eigen::MatrixXd& truth;    ///< r x m, no rows without a reference
};
using InstantsBlock = std::function<void(const InstantBlock& block)>;

/// An alignment of what the sensors would say of the input itself: samples / h.
struct SceneAlignment {
  fusion::Alignment alignment;
  Eigen::VectorXd h;  ///< a weight a sensor
  bool by_reference = false;
  std::int64_t from = 0, to = 0;  ///< instants it was learnt on
};

/// One instant: samples / h as recorded (saturated ones missing) with the further axes below them,
/// the same aligned, the truth.
struct AlignedSamples {
  const Eigen::VectorXd &recorded, &aligned, &truth;
};
using AlignedInstant = std::function<void(const AlignedSamples& instant)>;

void each_aligned(const Instants& instants, const SceneAlignment& alignment, std::int64_t from, std::int64_t to,
                  Progress& progress, const AlignedInstant& one);

/// Instants [from, to) in blocks of `size` columns, as Instants::pass.
void pass_aligned(const Instants& instants, const SceneAlignment& alignment, std::int64_t from, std::int64_t to,
                  std::size_t size, Progress& progress, const InstantsBlock& block);

}  // namespace libchar
