#pragma once
// What a replay found about the sensors themselves, before any fusion.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/numeric/interval.hpp"
#include "libchar/fusion/alignment.hpp"
#include "libchar/fusion/error_budget.hpp"
#include "libchar/replay/error_meter.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

struct SensorResult {
  std::string name, unit;
  ErrorScore error;                      ///< of y - h x; NaN without a reference
  std::optional<double> noise_variance;  ///< what algorithms were told
  std::string noise_source;              ///< "model", "rest", "scene", ""
  double offset = 0;                     ///< subtracted (mean over the rest)
  double missing = 0;                    ///< share of the instants of the run
  bool constant = false;                 ///< never changed during the run
  std::string copy_of;                   ///< the earlier sensor that it repeats, sample by sample
  std::vector<double> h;
};

/// What was learnt of the sensors before fusion, and what their errors are made of on the run.
struct AlignmentResult {
  /// A term of the alignment that was tried: errors on halves of the learning window, each taught by the other.
  struct Trial {
    std::string term;  ///< "bias", "delay", "delay, cubic", "gain", "misalignment"; "": as recorded
    double rmse =
        0;  ///< of weights learnt on the other half, with it and with the terms that were kept before
    double of_mean = 0;  ///< of the plain mean
    bool kept = false;
  };

  fusion::Alignment learnt;
  TimeWindow window;          ///< it was learnt on
  bool by_reference = false;  ///< by the reference; else by the sensors' mean
  bool applied = false;
  bool overlaps = false;  ///< learnt on a part of what is judged
  fusion::ErrorBudget budget;
  std::vector<std::size_t> budgeted;  ///< sensors in the budget
  std::vector<Trial> trials;          ///< where the terms were chosen; the first is without any
};

/// By how much the reference reads more than the sensors, as it was found; in the unit of the input.
struct FoundOffset {
  double value = 0;
  Interval ci95;             ///< NaN: too few instants
  TimeWindow window;         ///< it was found in
  bool in_learning = false;  ///< the learning window; else what is scored
  bool drifts = false;       ///< within that window
};

struct InputResult {
  std::string name, unit;
  double optimum_rmse = 0;  ///< of the best linear unbiased weights of the run; NaN: no reference
};

}  // namespace libchar
