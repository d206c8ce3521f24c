#pragma once
// What is known of a fusion algorithm before it is made: name, source, what it needs.

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace libchar::fusion {

/// Where all pairs of channels have numbers of their own: at most 160 MB of them.
inline constexpr std::ptrdiff_t kMostPaired = 2000;

struct Needs {
  std::ptrdiff_t min_channels = 1;
  std::ptrdiff_t max_channels = 0;      ///< 0: any number; else memory that grows with their square
  std::ptrdiff_t more_than_inputs = 0;  ///< n must exceed this many times r (MINQUE: 2)
  std::int64_t learning_samples = 0;    ///< at least so many instants with a reference before the run
  bool reference = false;               ///< learns from a reference, in the learning window
  bool reference_helps = false;         ///< learns from it where there is one, and runs without
  /// looks at the reference of the run itself: a bound, not a method
  bool reference_throughout = false;
  bool noise_levels = false;  ///< a noise variance for each channel
  bool noise_models = false;  ///< a noise model for each channel
  /// takes any H (otherwise every channel must see the one input with gain one)
  bool observation_matrix = false;
  bool accepts_missing = false;   ///< otherwise an instant with a missing sample has no estimate
  bool fault_free_start = false;  ///< a stretch without faults at the beginning of the run
  bool rate = false;              ///< the sampling rate
  bool tilt = false;              ///< one gyroscope axis and two accelerometer axes
};

/// What the plan, the docs and the report print about an algorithm.
struct Description {
  std::string_view name;        ///< stable key: "inverse-variance"
  std::string_view title;       ///< one line
  std::string_view source;      ///< of the equations
  std::string_view complexity;  ///< of a step
  Needs needs = {};
  /// of one learning instant; "" when nothing is learnt
  std::string_view learning_complexity = "";
  bool as_published = false;  ///< in the source's own form, next to a more robust one
  /// rank among the methods that one failing sensor of at least three does not lead astray: the
  /// highest is taken where no score decides; 0: it does
  int withstands = 0;
};

}  // namespace libchar::fusion
