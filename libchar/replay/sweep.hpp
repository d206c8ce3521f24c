#pragma once
// Options of algorithms from the command line: one value, or a row of them that makes an algorithm run several times.

#include <string>
#include <vector>

#include "libchar/scene/scene.hpp"

namespace libchar {

struct Sweep {
  std::string algorithm, option;
  std::vector<double> values;
};

/// "minque.gamma=0.99", "minque.gamma=.9,.99,.999", "perceptron.neurons=3..30" (whole numbers, all
/// of up to twelve, else twelve at about equal ratios). `where` is the option of the command line,
/// for messages. Throws Error(usage): another form, an unknown algorithm or option, a value out of
/// range, more than `most` values.
Sweep parse_sweep(const std::string& text, const std::string& where, std::size_t most = 100);

/// Every algorithm of the list that is swept is listed once for each combination of the values;
/// one that is not in the list is added.
std::vector<SceneAlgorithm> swept(const std::vector<Sweep>& sweeps,
                                  const std::vector<SceneAlgorithm>& algorithms);

}  // namespace libchar
