#pragma once
#include <string>

namespace libchar {

/// Text, and a unit, as LaTeX has them: no package, no character beyond ASCII of those that units
/// and numbers here consist of.
std::string latex_text(const std::string& text);
std::string latex_unit(const std::string& unit);

}  // namespace libchar
