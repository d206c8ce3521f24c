#pragma once
// A fit as JSON, one element of "channels" in `fit --json` and in report.json (docs/json.md).

#include <string>

#include "libchar/core/document/fields.hpp"
#include "libchar/fit/fit_result.hpp"

namespace libchar {

/// What a channel of a document says of its fit after its name and unit. "{unit}" and
/// "{white_noise}"… stand for the units.
const Fields<NoiseFit>& noise_fit_fields();
/// "residuals": long, and on request only.
const Fields<NoiseFit>& fit_residual_fields();

/// Keys that scripts rely on: name, unit, one object per term {value, ci95, status, upper95…}, second_opinion,
/// goodness. What is not known is null, never absent among those. Residuals only on request: they are long.
Json noise_fit_json(const std::string& name, const std::string& unit, const NoiseFit& fit, bool with_residuals = false);

/// The place of a channel that could not be fitted: every term not_fitted, no goodness, and why.
Json no_fit_json(const std::string& name, const std::string& unit, const std::vector<Finding>& why = {});

/// {"format":"noise-fit","version":1,"density_sides":"two","channels":[…]}
Json noise_fit_document(Json channels);

}  // namespace libchar
