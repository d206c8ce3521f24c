#pragma once
// A characterization held against the limits of a data sheet: pass, fail, or not decided.
//
// By the 95 % interval of a coefficient: a term exactly at its limit passes, or fails, by chance in at most 2.5 % of
// recordings (5 % where only an upper limit is known).

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/model/noise_limits.hpp"

namespace libchar {

enum class LimitStatus {
  pass,         ///< the whole interval, or the upper 95 % limit of a term not detected, is within the limit
  fail,         ///< the whole interval is above it
  not_decided,  ///< the interval straddles it, or the coefficient cannot be relied on
};
template <>
inline constexpr auto enum_table<LimitStatus> = enum_words<LimitStatus, "pass fail not_decided">;

struct LimitJudgement {
  std::string channel, unit;  ///< unit of the channel
  Term term = Term::white;
  double most = 0;       ///< the limit in the term's own unit
  std::string text;      ///< the limit as in its file
  Coefficient measured;  ///< not_fitted: there is no fit
  LimitStatus status = LimitStatus::not_decided;
  std::string sentence;  ///< how it was decided, with numbers
};

/// A limit as in its file, and in the unit of the values that are compared with it: "0.4 deg/√h (0.006667
/// deg/s·√s)".
std::string limit_text(const std::string& text, double most, const std::string& unit);

struct LimitReport {
  std::string file, sensor;
  std::vector<LimitJudgement> judgements;
  std::string verdict;  ///< "2 of 6 limits fail: gyro_x white noise …"
  std::size_t count(LimitStatus status) const;
};

/// One coefficient against its limit.
LimitStatus judge_limit(const Coefficient& measured, double most);

/// A channel with its fit; null: there is none.
struct LimitSubject {
  Channel channel;
  const NoiseFit* fit = nullptr;
};

/// Throws as limits_for.
LimitReport judge_limits(const std::vector<LimitSubject>& subjects, const NoiseLimits& limits);
LimitReport judge_limits(const Characterization& result, const NoiseLimits& limits);

}  // namespace libchar
