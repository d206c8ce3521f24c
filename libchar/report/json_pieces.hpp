#pragma once
// One channel's share of each shared document (outputs_json.cpp), for those who assemble them.

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// With a model, also what it predicts at each point.
Json allan_channel_json(const Channel& channel, const AllanCurve& curve, const ModelCurve* model);
/// `ci95`: one a bin.
Json spectrum_channel_json(const Channel& channel,
                           const Spectrum& spectrum,
                           const ModelCurve* model,
                           const std::vector<std::optional<Interval>>& ci95);
Json spectrum_channel_json(const Channel& channel,
                           const Spectrum& spectrum,
                           const ModelCurve* model = nullptr);

}  // namespace libchar
