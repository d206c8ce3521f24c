#pragma once
// The model files that a place holds: somebody who characterized a log has a folder and a report in his hand.

#include <string>
#include <vector>

namespace libchar {

/// Of a folder of results, or its report.json, the model files in it, in the order of the channels; of a
/// folder of such folders, those of all; of any other file, itself. Throws Error(input) where a folder holds none.
std::vector<std::string> model_files(const std::string& path);

}  // namespace libchar
