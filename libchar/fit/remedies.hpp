#pragma once
// What is done about data that break the model, each only when its alarm asks: spikes and lines. What the spectrum asks
// for is the band's (detail/band.hpp), what the record shows in time the events' (events.hpp).

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "libchar/fit/fit_result.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "libchar/fit/signs/spike_cleaner.hpp"

namespace libchar {

/// Kurtosis of first differences above which spikes are looked for: 3.1, or five standard
/// deviations above 3 in a short record.
double spike_alarm(std::uint64_t samples);

/// Kurtosis of the first differences of a record; NaN are skipped.
double kurtosis_of_differences(std::span<const double> record);

/// Treatment of outliers of a record: left out, or kept with a sentence that says why.
struct SpikeAnswer {
  std::optional<Remedy> remedy;             ///< the spikes are to be left out
  std::optional<Finding> kept;              ///< or the reason for keeping them; none without outliers
  std::optional<OutlierVariance> outliers;  ///< that are left in what is fitted
};
SpikeAnswer spike_answer(double kurtosis, double alarm, const SpikeCount& count);

/// A record and what became of its spikes, looked for only when the kurtosis asks for it.
struct DespikedRecord {
  std::vector<double> samples;  ///< with spikes missing (NaN); empty: as the record was
  SpikeAnswer answer;
};
/// `kurtosis`: of the first differences, where it is known.
DespikedRecord without_spikes(std::span<const double> record, std::optional<double> kurtosis = {});

/// Puts the answer before what else a fit says.
void add_spike_answer(const SpikeAnswer& answer, NoiseFit& fit);

Remedy lines_remedy(std::uint64_t clipped);

namespace detail {
/// Fills missing readings of a clock's phase with draws of what is around. A rate across a missing reading is not a
/// missing rate: the phase goes on from where it was. Up to three quarters of the readings are filled, in runs of up to
/// an eighth of the record. In place.
void bridge_phase(std::vector<double>& phase);
/// What a fit knows where `share` of the readings were missing.
void doubt_bridged(double share, NoiseFit& fit);
/// Standard deviation of the kurtosis of first differences of white noise.
double kurtosis_sd(std::uint64_t samples);
/// The finding about lines that were left out. `in_allan`: the Allan curve has them, and disagrees.
Finding lines_finding(const ClippedBins& lines, bool in_allan);
/// Share of the power that lines hold, of the samples or of their differences: the larger.
double share_of_lines(const ClippedBins& lines);
/// The finding about slow cycles that were taken out; by frequency, at least one.
Finding cycle_finding(std::span<const Event> cycles);
}  // namespace detail

/// What a fit did of a kind; null: nothing.
const Remedy* find_remedy(const NoiseFit& fit, std::string_view kind);

}  // namespace libchar
