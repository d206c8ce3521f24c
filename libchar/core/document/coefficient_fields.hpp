#pragma once
// What documents say of a noise coefficient, of all terms, and of how well a model fits.

#include "libchar/core/coefficient.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/finding.hpp"

namespace libchar {

/// Words of an enum's table with comments, and of `Coefficient::profile`.
std::span<const Word> status_words();
std::span<const Word> interval_words();
/// "white_noise"…: of a Term.
std::span<const Word> term_words();

/// All that is known of a coefficient, its unit left out.
const Fields<Coefficient>& coefficient_fields();

const Fields<Goodness>& goodness_fields();

// A finding in a document: written by reports and models, read back by what uses them.

const Fields<Finding>& finding_fields();

}  // namespace libchar
