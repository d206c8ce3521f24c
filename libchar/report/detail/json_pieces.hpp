#pragma once
// What several JSON documents share: their head, an interval, and one channel's part of a document (json_pieces.cpp).

#include <string_view>

#include "libchar/characterize/characterization_view.hpp"

namespace libchar {

/// The head of a document: its format and version.
Json json_frame(std::string_view format);
/// ["…", …]
Json texts_json(const std::vector<std::string>& texts);
/// [{code, message, count, where}…]
Json warnings_json(const Warnings& warnings);
/// [low, high]; null where it is not known.
Json interval_json(const Interval& interval);

/// With a model, also what it predicts at each point.
Json allan_channel_json(const Channel& channel, const AllanCurve& curve, const ModelCurve* model);
/// `ci95`: one a bin.
Json spectrum_channel_json(const Channel& channel,
                           const Spectrum& spectrum,
                           const ModelCurve* model,
                           const std::vector<std::optional<Interval>>& ci95);

}  // namespace libchar
