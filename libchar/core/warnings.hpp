#pragma once
#include "libchar/core/finding.hpp"

namespace libchar {

using Warning = Finding;
using Warnings = Findings;

}  // namespace libchar
