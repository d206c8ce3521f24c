#pragma once
#include <string>
#include <string_view>

namespace libchar {

/// A word quoted for a POSIX shell where it has to be.
std::string shell_word(std::string_view word);

}  // namespace libchar
