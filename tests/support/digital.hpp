#pragma once
// What the converter and the link did to samples in memory: by their quality, as `characterize` takes it.

#include "libchar/characterize/detail/leaf.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/fit/signs/digital.hpp"

namespace test {

using namespace libchar;

inline DigitalFaults digital_faults(std::span<const double> record, double rate_hz, std::optional<double> step = {},
                                    std::string_view unit = {}) {
  QualityMeter meter;
  meter.push(record);
  const ChannelQuality quality = meter.finish(rate_hz);
  const ValueCensus census = census_of(quality);
  DigitalFaults faults =
      find_digital_faults(digital_sums(record, census, count_missing(record)), census, rate_hz, step, unit);
  for (const Finding& one : quality.findings)
    if (one.code == "held_values") faults.findings.push_back(one);
  return faults;
}

}  // namespace test
