#include "libchar/fusion/learnt.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar::fusion {
namespace {

constexpr const char* kHint = "write the file again with the replay that learnt it";

Refusal learnt_refusal(std::string_view name, const std::string& what) {
  return input_error("E0866").says("learnt." + std::string(name) + ": " + what);
}

}  // namespace

const std::vector<double>& LearntExchange::find(std::string_view name) {
  for (std::size_t i = 0; i < learnt_.size(); ++i)
    if (learnt_[i].name == name) {
      taken_[i] = 1;
      return learnt_[i].values;
    }
  throw learnt_refusal(name, "is missing").hint(kHint);
}

void LearntExchange::check(std::string_view name, std::size_t wanted, std::size_t found) const {
  if (wanted == found) return;
  throw learnt_refusal(name, "expected " + std::to_string(wanted) + " numbers, found " + std::to_string(found))
      .hint("the file must name as many sensors as it was learnt from");
}

void LearntExchange::number(std::string_view name, double& value) {
  if (!taking_in_) {
    learnt_.push_back({std::string(name), {value}});
    return;
  }
  const std::vector<double>& values = find(name);
  check(name, 1, values.size());
  value = values[0];
}

void LearntExchange::numbers(std::string_view name, std::span<double> values) {
  if (!taking_in_) {
    learnt_.push_back({std::string(name), {values.begin(), values.end()}});
    return;
  }
  const std::vector<double>& found = find(name);
  check(name, values.size(), found.size());
  std::copy(found.begin(), found.end(), values.begin());
}

void LearntExchange::list(std::string_view name, std::vector<double>& values) {
  if (taking_in_)
    values = find(name);
  else
    learnt_.push_back({std::string(name), values});
}

void LearntExchange::needs_same_rate(std::string_view what) const {
  if (!taking_in_ || std::abs(rate_ratio_ - 1) <= kSameRate) return;
  throw input_error("E0867")
      .says("the log's rate is " + brief_text(rate_ratio_, 4) +
            " times that of the log where this was learnt: " + std::string(what) + " would mean something else")
      .hint("learn on a log of this rate, or choose another algorithm");
}

void LearntExchange::finish() const {
  for (std::size_t i = 0; i < learnt_.size(); ++i)
    if (taking_in_ && taken_[i] == 0)
      throw learnt_refusal(learnt_[i].name, "this algorithm learns nothing of this name").hint(kHint);
}

}  // namespace libchar::fusion
