#include "libchar/fusion/why_not.hpp"

#include <string>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {
namespace {

std::string count(Eigen::Index n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// How many channels an algorithm wants for the inputs of this scene.
Eigen::Index wanted_channels(const Needs& needs, const Array& array) {
  return std::max(needs.min_channels, needs.more_than_inputs > 0 ? needs.more_than_inputs * array.inputs() + 1 : 1);
}

bool known(const Eigen::VectorXd& levels, Eigen::Index channels) {
  return levels.size() == channels && levels.allFinite() && (levels.array() > 0).all();
}

/// Columns of H in unit length differ by more than what rounding of samples leaves.
bool tells_inputs_apart(const Array& array) {
  constexpr double kRounding = 1e-12;
  if (array.observation_matrix.size() == 0 || array.channels < array.inputs()) return true;
  const Eigen::VectorXd length = array.observation_matrix.colwise().norm();
  if (!(length.minCoeff() > 0)) return false;
  const Eigen::VectorXd r = thin_qr(array.observation_matrix * length.cwiseInverse().asDiagonal()).r_diagonal;
  return r.cwiseAbs().minCoeff() > kRounding;
}

}  // namespace

std::string why_not(const Description& description, const Array& array) {
  const Needs& needs = description.needs;
  if (needs.tilt && !array.tilt)
    return "needs a gyroscope axis and two accelerometer axes; say in the scene which channels they are";
  if (!needs.tilt && array.tilt) return "needs channels that measure one thing; a gyroscope and accelerometers do not";
  if (array.inputs() > kMaxStates)
    return "estimates at most " + std::to_string(kMaxStates) + " inputs; this scene has " +
           std::to_string(array.inputs());
  if (!needs.tilt && !needs.observation_matrix && !array.one_common_input())
    return array.inputs() > 1
               ? "estimates one input; this scene has " + std::to_string(array.inputs())
               : "needs channels that see the input with gain one; this scene's observation matrix says otherwise";
  if (!needs.tilt && !tells_inputs_apart(array))
    return "needs sensors that tell the inputs apart; by this scene's observation matrix " +
           count(array.inputs(), "input leaves", "inputs leave") + " the same in all of them";
  if (array.channels < wanted_channels(needs, array)) {
    std::string sentence = "needs at least " + count(wanted_channels(needs, array), "channel", "channels");
    if (needs.more_than_inputs > 0) sentence += " for " + count(array.inputs(), "input", "inputs");
    sentence += "; this scene has " + std::to_string(array.channels);
    if (needs.more_than_inputs == 2 && array.inputs() == 1 && array.channels == 2)
      sentence += " (the difference of two channels tells the sum of their variances, not which is the noisier)";
    return sentence;
  }
  if (needs.max_channels > 0 && array.channels > needs.max_channels)
    return "takes at most " + std::to_string(needs.max_channels) +
           " channels (its memory grows with their square); this scene has " + std::to_string(array.channels);
  if (needs.noise_levels && !known(array.noise_levels, array.channels))
    return "needs the noise level of each sensor: give `models`, noise or a stretch at rest";
  if (needs.noise_models && static_cast<Eigen::Index>(array.noise_models.size()) != array.channels)
    return "needs a noise model of each channel, and its noise level; give each sensor its model";
  if (needs.reference_throughout && !array.reference_throughout)
    return "looks at the reference all along; this scene has none over the run";
  if (needs.reference && array.learning_samples == 0)
    return "learns from a reference in a learning window (learning: [from, to]), and there is none";
  if (array.learning_samples < needs.learning_samples)
    return "learns from at least " + count(static_cast<Eigen::Index>(needs.learning_samples), "instant", "instants") +
           "; the learning window has " + std::to_string(array.learning_samples);
  if (needs.fault_free_start && array.fault_free_samples <= 0)
    return "needs a stretch at the start that is known to hold no fault; say in the scene how long it is";
  if (needs.rate && !(array.rate_hz > 0)) return "needs the sampling rate; the recording has no time axis";
  return "";
}

}  // namespace libchar::fusion
