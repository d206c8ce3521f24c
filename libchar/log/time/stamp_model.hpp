#pragma once
// The model of a log's stamps, from the first of them:
//
//   stamp = instant of a clock (one interval, now and then a missing row or a pause)
//         + what the way to the log adds (jitter, a delay, a coarse step, a packet)
//
// What it says decides which longer step is a gap. Steps back (rollovers, restarts) are the matter of clock_breaks.hpp.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace libchar {

/// How stamps and samples go together.
enum class StampPattern {
  steps,     ///< a stamp for each sample, as far as the clock can tell; longer steps are gaps
  equal,     ///< so many equal stamps that the clock cannot tell rows apart
  coarse,    ///< on the grid of a coarse clock, never more than a step off an even rate
  packets,   ///< rows that arrive together have stamps of their arrival
  uneven,    ///< steps of unlike length that keep to one line: messages that take turns
  disputed,  ///< most steps say one rate, all of them together another, and gaps do not explain it
};

struct StampModel {
  double ns = 0;            ///< sampling interval; what tells a gap from a step
  double longest_step = 0;  ///< a longer one may be a gap, ns
  StampPattern pattern = StampPattern::steps;
  double step_ns = 0;  ///< the common step alone
  double span_ns = 0;  ///< rows over time, pauses left out
  /// Of packets.
  struct Packets {
    double rows = 0;        ///< of each, in the mean; 0: the stamps are none of packets
    bool alike = false;     ///< all of them have as many
    double scatter_ns = 0;  ///< of first rows, where those behind them stand evenly; 0: they do not
  } packets = {};
};

/// From the first stamps, in file order. `rate_hz` decides where stamps can be read in two ways.
StampModel model_of_stamps(const std::vector<std::int64_t>& stamps, std::optional<double> rate_hz = {});

/// A logger that hung writes what it missed at once: rows behind the first of these, until steps of about an interval
/// follow each other.
struct RowsAtOnce {
  double interval = 0;      ///< ns
  std::int64_t before = 0;  ///< the last stamp
  std::size_t rows = 0, shorter = 0, regular = 0;

  static constexpr std::size_t kMost = 4096, kRegular = 8, kFewest = 3;
  /// Rows that are kept for this: fewer of very many channels.
  static constexpr std::size_t most(std::size_t channels) {
    constexpr std::size_t kValues = std::size_t{1} << 20U, kFew = 64;
    return std::clamp(kValues / std::max<std::size_t>(channels, 1), kFew, kMost);
  }
  /// The next row; false where no more are to be looked at.
  bool add(std::int64_t stamp);
  /// 0 where few steps are short, or none are regular; of stamps that only scatter half of them are.
  std::size_t count() const {
    const std::size_t late = rows - regular;
    return shorter < kFewest || 10 * shorter < 7 * late || rows == kMost ? 0 : late;
  }
};

/// The same stamps, such rows (fewer than half of all) one interval apart in front of the last of them; without those
/// that the end cuts.
std::vector<std::int64_t> caught_up(const std::vector<std::int64_t>& stamps);

/// How many of the first rows come at once, as from a buffer that was full when the log began.
std::size_t at_once_in_front(const std::vector<std::int64_t>& stamps);

/// One interval up to a row, another one from there on.
struct RateChange {
  double row = 0;  ///< where the two lines meet
  double before_ns = 0, after_ns = 0;
};

/// Where the instants of those rows change their rate for good by 3 % and more; nothing where they
/// keep it, drift, or scatter by more than that.
std::optional<RateChange> find_rate_change(std::span<const double> rows, std::span<const double> instants);

/// The same of stamps in file order, pauses and steps back left out.
std::optional<RateChange> find_rate_change(const std::vector<std::int64_t>& stamps);

/// Rows that a row is late by, all of them together: a single late row whose followers are on time
/// is no gap. `lags` starts with the row's own.
double common_lag(std::vector<double> lags);

}  // namespace libchar
