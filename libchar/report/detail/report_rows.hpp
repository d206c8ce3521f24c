#pragma once
// What a report says beside curves and fits: a sentence a channel, what the samples say, rest,
// limits.

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/comparison.hpp"
#include "libchar/replay/fuse.hpp"

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

/// Without head and files.
const Fields<Comparison>& comparison_fields();
const Fields<FuseResult>& fuse_fields();
const Fields<fusion::Entry>& algorithm_entry_fields();

}  // namespace libchar
