#pragma once
// What a report says beside curves and fits: a sentence a channel, what the samples say, rest, limits.

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "libchar/characterize/characterization_view.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/document/json.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/log/recording_json.hpp"
#include "libchar/replay/comparison.hpp"
#include "libchar/replay/fuse.hpp"

namespace libchar {
// What several JSON documents share: their head, texts, an interval.

/// The head of a document: its format and version.
Json json_frame(std::string_view format);
/// ["…", …]
Json texts_json(const std::vector<std::string>& texts);
/// [VALUE(part), …], null for a number that is not known; `value`: a function, or a member of a part.
template <class Parts, class Value>
Json list_json(const Parts& parts, Value value) {
  Json out = Json::array();
  for (const auto& part : parts) {
    const auto one = std::invoke(value, part);
    if constexpr (std::is_floating_point_v<decltype(one)>)
      out.push_back(json_number(one));
    else
      out.push_back(one);
  }
  return out;
}
/// [low, high]; null where it is not known.
Json interval_json(const Interval& interval);

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
