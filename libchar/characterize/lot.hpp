#pragma once
// Several devices, or axes of one, side by side: mean and spread of each coefficient over the lot, and who does not belong to it.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/characterize/lot_figures.hpp"
#include "libchar/core/random_effects.hpp"

namespace libchar {

/// A channel of a device.
struct LotMember {
  std::size_t device = 0, channel = 0;  ///< indices
};

struct LotOutlier {
  LotMember member;
  double ratio = 1;  ///< of a coefficient: to the mean of the lot; of a bias: 1
  double p = 1;      ///< of so large a deviation of any member
  std::string sentence;
};

/// One quantity over the members of a group.
struct LotStatistic {
  std::string group;         ///< "gyro_x", or "angular_rate in deg/s" for all channels of a kind
  bool of_kind = false;      ///< of all channels of a kind, not of one channel of several devices
  std::optional<Term> term;  ///< none: the mean of the samples
  std::string unit;          ///< of the values
  std::size_t members = 0;
  std::size_t not_detected = 0;    ///< upper limit only
  std::size_t doubtful = 0;        ///< undetermined, misfit, or no fit
  std::vector<LotMember> counted;  ///< those detected
  /// of ln(value) for coefficients, of the value for means; none: as lot_effects says
  std::optional<RandomEffects> effects;
  std::optional<LotFigures> figures;  ///< of `effects`, or of more:
  std::size_t in_figures =
      0;  ///< members that they are of; those not detected too, where their squares are known (lot_figures.hpp)
  std::vector<LotOutlier> outliers;
};

struct Lot {
  std::vector<std::string> devices;  ///< names, one a recording, none twice
  std::vector<LotStatistic> statistics;
  std::vector<std::string> not_compared;  ///< sentences: channels of one name and unlike units
  std::string verdict;                    ///< a paragraph
};

struct LotOptions {
  SampleKind data = SampleKind::rate;  ///< the mean of a phase is no bias
  double outlier_probability =
      0.01;  ///< of naming any member of a lot that has no outlier: each statistic gets its share
};

/// Throws Error(input) for one file twice, Error(usage) where there are not two channels.
Lot lot_of(std::span<const Characterization> devices, const LotOptions& options = {});

/// "White noise", "Mean".
std::string lot_title(const LotStatistic& statistic);

}  // namespace libchar
