#pragma once
// What to say of a file that does not begin with the mark of its format: one that was cut there is
// no file of another format.

#include <string>
#include <string_view>

namespace libchar {

/// Why `found`, the first bytes of a file, are not `mark`, in words: empty, cut inside the mark, or
/// not like `what` ("a bag").
std::string wrong_start(std::string_view found, std::string_view mark, std::string_view what);

}  // namespace libchar
