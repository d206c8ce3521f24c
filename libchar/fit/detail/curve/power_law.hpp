#pragma once
// Slow noise that is neither flicker nor a walk: S = Q² + h (2 pi f)^-alpha.

#include <optional>
#include <vector>

#include "libchar/fit/detail/band/band.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

struct PowerLawChoice {
  Band band;  ///< in which it was found; its `law` is set where that describes it without a shape
  double exponent = 1, exponent_sd = 0;
  double half_deviance = 0;
  bool needed = false;                 ///< the terms are rejected; else the law is likelier, and they may be right
  double likelihood_ratio = 0;         ///< 2 (lnL of white noise and the law - lnL of all offered terms)
  double white = 0, white_log_sd = 0;  ///< Q, and the sd of ln Q² with h and alpha unknown
};

/// The law where it beats all offered terms, which have one parameter more, by more than they do in 1 % of the records
/// that they describe, and is neither of them: over the whole spectrum where it describes that and `band`, of the
/// terms, is cut or has a shape; else in `band`.
std::optional<PowerLawChoice> choose_power_law(const std::vector<PowerBin>& bins, const Band& band, double rate_hz,
                                               const TermSet& terms);

/// The interval of white noise reaches to where it is with a law that is not needed.
void reach_to_law(const PowerLawChoice& law, NoiseFit& fit);

/// White noise as it is beside the law; flicker and walk stand in for it and are borne out by nothing.
void answer_power_law(const PowerLawChoice& law, NoiseFit& fit);

}  // namespace libchar
