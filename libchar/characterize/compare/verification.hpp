#pragma once
// The loop closed: a sensor is simulated from the model that a recording gave, characterized the
// same way, and the two are compared ([RV fig. 2.6, 2.8]).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/process/progress.hpp"

namespace libchar {

/// One noise term: what the model says and what the fit of the simulated record found.
struct TermVerification {
  Term term = Term::white;
  Coefficient model, simulated;
  bool agrees = true;
};

/// The two Allan curves at one averaging time.
struct PointVerification {
  double tau_s = 0;
  double ratio = 1;  ///< deviation of the recording / of the simulation
  double p = 1;      ///< two-sided, F distribution with the degrees of freedom of both
  bool agrees = true;
};

struct ChannelVerification {
  AllanCurve allan;  ///< of the simulated record, with intervals
  Spectrum spectrum;
  std::optional<NoiseFit> fit;
  std::vector<TermVerification> terms;
  std::vector<PointVerification> points;
  bool agrees = false;
  /// the coefficients agree, and no averaging time is further off than `VerifyOptions::tolerable`: true where all
  /// agrees
  bool nearly = false;
  std::vector<std::string> sentences;  ///< the verdict first, then what disagrees
};

struct VerifyOptions {
  std::uint64_t seed = 1;
  double term_sd = 3;               ///< a term disagrees beyond this many standard deviations of its simulated fit
  double point_probability = 0.01;  ///< over all points of a curve together (each gets its share)
  double small_difference = 0.03;   ///< relative difference of deviations that is never called a disagreement
  double tolerable = 0.1;           ///< relative difference of deviations up to which a model is nearly right
};

/// Simulates every fitted channel for as long as its samples went, characterizes it with the same
/// options and leaves the comparison in `verification`. Returns whether all of them agree.
bool verify(Characterization& recorded, const CharacterizeOptions& options, const VerifyOptions& how = {},
            Progress& progress = no_progress());

}  // namespace libchar
