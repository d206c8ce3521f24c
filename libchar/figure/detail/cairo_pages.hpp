#pragma once
// PDF and PNG, by Cairo: the only user of it.

#include <string>

#include "libchar/core/finding.hpp"
#include "libchar/figure/detail/drawing.hpp"

namespace libchar {

bool has_cairo();

/// One page. A PDF has no date of its own (SOURCE_DATE_EPOCH gives it one), so that the same
/// drawing gives the same bytes.
std::string pdf_of(const Drawing& drawing, Findings& warnings);
std::string png_of(const Drawing& drawing, double dpi, Findings& warnings);

}  // namespace libchar
