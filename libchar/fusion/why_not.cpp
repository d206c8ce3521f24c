#include <cmath>
#include <string>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {
namespace {

std::string count(Eigen::Index n, const char* one, const char* many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

/// How many channels an algorithm wants for the inputs of this scene.
Eigen::Index wanted_channels(const Needs& needs, const Given& given) {
  return std::max(needs.min_channels,
                  needs.more_than_inputs > 0 ? needs.more_than_inputs * given.inputs() + 1 : 1);
}

bool known(const Eigen::VectorXd& levels, Eigen::Index channels) {
  return levels.size() == channels && levels.allFinite() && (levels.array() > 0).all();
}

}  // namespace

std::string why_not(const Card& card, const Given& given) {
  const Needs& needs = card.needs;
  const std::string name(card.name);
  if (needs.tilt && !given.tilt)
    return name +
           " needs a gyroscope axis and two accelerometer axes; say in the scene which channels "
           "they are";
  if (!needs.tilt && given.tilt)
    return name + " needs channels that measure one thing; a gyroscope and accelerometers do not";
  if (given.inputs() > kMaxStates)
    return name + " estimates at most " + std::to_string(kMaxStates) + " inputs; this scene has " +
           std::to_string(given.inputs());
  if (!needs.tilt && !needs.observation_matrix && !given.plain())
    return given.inputs() > 1
               ? name + " estimates one input; this scene has " + std::to_string(given.inputs())
               : name +
                     " needs channels that see the input with gain one; this scene's observation "
                     "matrix says otherwise";
  if (given.channels < wanted_channels(needs, given)) {
    std::string sentence =
        name + " needs at least " + count(wanted_channels(needs, given), "channel", "channels");
    if (needs.more_than_inputs > 0) sentence += " for " + count(given.inputs(), "input", "inputs");
    sentence += "; this scene has " + std::to_string(given.channels);
    if (needs.more_than_inputs == 2 && given.inputs() == 1 && given.channels == 2)
      sentence +=
          " (the difference of two channels tells the sum of their variances, not which is the "
          "noisier)";
    return sentence;
  }
  if (needs.noise_levels && !known(given.noise_levels, given.channels))
    return name +
           " needs a noise level (above zero) for each channel; give a sensor model, noise or a "
           "rest";
  if (needs.reference_throughout && !given.reference_throughout)
    return name + " looks at the reference all along; this scene has none over the run";
  if (needs.reference && given.learning_samples == 0)
    return name +
           " learns from a reference; this scene has no reference in a learning window (learning: "
           "[from, to])";
  if (given.learning_samples < needs.learning_samples)
    return name + " learns from at least " + count(needs.learning_samples, "instant", "instants") +
           "; the learning window has " + std::to_string(given.learning_samples);
  if (needs.fault_free_start && given.fault_free_samples <= 0)
    return name +
           " needs a stretch at the start that is known to hold no fault; say in the scene how "
           "long it is";
  if (needs.rate && !(given.rate_hz > 0))
    return name + " needs the sampling rate; the recording has no time axis";
  return "";
}

}  // namespace libchar::fusion
