#pragma once
// Runs of a sign that samples have or not (equal to the one before, on a line with the two before): how long, how many,
// where. Of parts of a record joined: those of the record, whatever the cut.

#include <cstdint>
#include <utility>
#include <vector>

#include "libchar/core/numeric/state_archive.hpp"

namespace libchar::detail {

class FlagRuns {
 public:
  static constexpr std::size_t kLongestCounted = 1024;
  using Place = std::pair<std::uint64_t, std::uint64_t>;  ///< from, to: indices of flags

  /// Places are kept of runs of so many flags, the first 32.
  explicit FlagRuns(std::uint64_t place_from) : place_from_(place_from) {}

  /// `at`: its index in the record.
  void push(bool flag, std::uint64_t at) { flag ? push_run(1, at) : push_without(1); }
  /// `n` flags from the index `at` on.
  void push_run(std::uint64_t n, std::uint64_t at);
  void push_without(std::uint64_t n);
  /// `later` begins at the index `at`, and its flags `skipped` samples further on, which were pushed.
  void join(const FlagRuns& later, std::uint64_t at, std::uint64_t skipped);

  std::uint64_t now() const { return now_; }    ///< flags in a row at the end
  std::uint64_t lead() const { return lead_; }  ///< at the beginning
  std::uint64_t set() const { return set_; }
  std::uint64_t longest() const { return longest_; }
  /// But for one of those that are longest; of several beyond kLongestCounted no more than that is known.
  std::uint64_t second_longest() const;
  /// Runs of `least` flags and more, and the flags in them.
  std::pair<std::uint64_t, std::uint64_t> from_length(std::uint64_t least) const;
  /// Those with both ends in the record: [length], up to kLongestCounted; empty: none.
  const std::vector<double>& closed() const { return closed_; }
  std::uint64_t pauses() const { return seen_ - set_; }
  /// Standard deviation over mean of the distance between flags: near 1 by chance.
  double unevenness() const;
  const std::vector<Place>& places() const { return places_; }

  static void layout(auto& at, auto& runs) {
    at.group("runs of a channel", runs.seen_, runs.set_, runs.now_, runs.lead_, runs.longest_);
    at.group("their distances", runs.first_, runs.last_, runs.spacing_, runs.spacing2_);
    at(runs.closed_);
    at.list(runs.places_, 16, [&](auto& place) { at(place.first, place.second); });
  }
  void check(StateReader& from) const;

 private:
  bool all() const { return set_ == seen_; }
  void close(std::uint64_t length, double times = 1);
  void add_distance(std::uint64_t distance);

  static constexpr std::size_t kMostPlaces = 32;
  std::uint64_t place_from_ = 0;
  std::uint64_t seen_ = 0, set_ = 0, now_ = 0, lead_ = 0, longest_ = 0;
  std::uint64_t first_ = 0, last_ = 0;  // flags, counted from the first one seen
  double spacing_ = 0, spacing2_ = 0;
  std::vector<double> closed_;
  std::vector<Place> places_;
};

}  // namespace libchar::detail
