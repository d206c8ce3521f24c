#pragma once
// A record of any length as means on its own clock, in constant memory: what events, motion and
// slow changes are looked for in.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/numeric/halving.hpp"
#include "libchar/fit/signs/event.hpp"

namespace libchar {

/// Means of what is present of 1, 2, 4… samples; at most 2^16 of them.
class MeanMeter {
 public:
  MeanMeter() = default;
  /// `per_mean`: samples in a mean at first, a power of two.
  explicit MeanMeter(std::uint64_t per_mean) : all_{.length = per_mean} {}
  void push(std::span<const double> samples);
  /// The samples that `later` has seen follow directly. What is here must be a whole number of its means.
  void join(MeanMeter later);
  /// Of the record times a factor.
  void scale(double factor);

  /// NaN: none of its samples is present. A last mean of fewer samples is not among them.
  std::vector<double> means() const;
  std::uint64_t per_mean() const { return all_.length; }
  std::uint64_t samples() const { return all_.samples(); }
  std::uint64_t missing() const;
  /// As `event_series` makes it of the samples. Throws Error(numeric) for fewer than 64 means.
  EventSeries series(double rate_hz) const;
  /// As `event_series` makes it of the samples of a part, on its clock.
  EventSeries series(double rate_hz, const Interval& part_s) const;

  void write_state(StateWriter& to) const;
  void read_state(StateReader& from);

 private:
  static constexpr std::size_t kMostKept = std::size_t{1} << 16U;
  struct Mean {
    double value = 0;
    std::uint64_t present = 0;
    void take(std::span<const double> samples);
    void join(const Mean& later);
    static void layout(auto& at, auto& mean) { at(mean.value, mean.present); }
  };

  detail::Halving<Mean, kMostKept> all_;
};

}  // namespace libchar
