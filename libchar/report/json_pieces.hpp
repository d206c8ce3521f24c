#pragma once
// One channel's share of each shared document (outputs_json.cpp), for those who assemble them.

#include "libchar/characterize/characterization.hpp"
#include "libchar/spectrum/spectrum_interval.hpp"

namespace libchar {

/// With a fit, also "model": what it predicts at each point.
Json allan_channel_json(const Channel& channel, const AllanCurve& curve, const NoiseFit* fit);
Json spectrum_channel_json(const Channel& channel, const Spectrum& spectrum, const NoiseFit* fit);
/// With `in95` shared by the channels.
Json spectrum_channel_json(const Channel& channel,
                           const Spectrum& spectrum,
                           const NoiseFit* fit,
                           IntervalFactors& in95);

}  // namespace libchar
