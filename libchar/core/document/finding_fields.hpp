#pragma once
// A finding in a document: written by reports and models, read back by what uses them.

#include "libchar/core/document/fields.hpp"
#include "libchar/core/finding.hpp"

namespace libchar {

const Fields<Finding>& finding_fields();

}  // namespace libchar
