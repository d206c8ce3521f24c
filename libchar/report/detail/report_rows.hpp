#pragma once
// What a report says beside curves and fits: a sentence a channel, what the samples say, rest,
// limits.

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/log/recording_json.hpp"

namespace libchar {

struct SummaryOfChannel {
  std::string name;
  Rating rating = Rating::good;
  std::string sentence;
  std::vector<Finding> findings;
};

struct QualityOfChannel {
  DescribedChannel described;
  DigitalFaults digital;
  std::vector<SpectralLine> lines;
};

const Fields<SummaryOfChannel>& summary_fields();
const Fields<QualityOfChannel>& quality_fields();
const Fields<Stretch>& still_fields();
const Fields<LimitReport>& limit_report_fields();

}  // namespace libchar
