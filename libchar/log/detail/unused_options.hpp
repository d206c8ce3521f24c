#pragma once
// Options of reading that have no effect are refused: who gave them expects one.

#include "libchar/log/formats.hpp"
#include "libchar/log/read.hpp"

namespace libchar {

/// Throws Error(usage) where an option that only other formats have is not at its default.
void refuse_unused_options(const LogFormat& format, const ReadOptions& options);

}  // namespace libchar
