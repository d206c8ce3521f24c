// Three-sample residual e_t = y_t - (y_{t-1} + y_{t+1})/2. A spike at t stands out in e_t with its
// full height and in the neighbours with half of it; drift and slow noise cancel. Sample t is
// replaced by the mean of its neighbours when
//   |e_t| > mad_limit * 1.4826 * median|e|   and   |e_t| > |e_{t+1}|   (|e_{t-1}| was settled
//   before: cleaned, or smaller).
// Under Gaussian noise 6 robust standard deviations are passed once in 5e8 samples.
#include "libchar/fit/spike_cleaner.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

constexpr double kMadToSd = 1.482602218505602;  // 1 / Phi^-1(3/4)

double residual(double before, double at, double after) {
  return at - 0.5 * (before + after);
}

}  // namespace

double spike_limit(std::span<const double> record, double mad_limit) {
  if (record.size() < 3) return 0;
  const std::size_t stride = std::max<std::size_t>(1, record.size() / 65536);
  std::vector<double> size;
  for (std::size_t t = 1; t + 1 < record.size(); t += stride) {
    const double e = residual(record[t - 1], record[t], record[t + 1]);
    if (std::isfinite(e)) size.push_back(std::abs(e));
  }
  if (size.size() < 8) return 0;
  const auto middle = size.begin() + static_cast<std::ptrdiff_t>(size.size() / 2);
  std::nth_element(size.begin(), middle, size.end());
  return mad_limit * kMadToSd * *middle;
}

SpikeCleaner::SpikeCleaner(double mad_limit, std::size_t pilot)
    : mad_limit_(mad_limit), pilot_(pilot) {}

SpikeCleaner SpikeCleaner::with_limit(double limit) {
  SpikeCleaner cleaner(0, 0);
  cleaner.limit_ = std::max(limit, 0.0);
  return cleaner;
}

std::span<const double> SpikeCleaner::push(std::span<const double> samples) {
  held_.insert(held_.end(), samples.begin(), samples.end());
  ready_.clear();
  if (limit_ < 0) {
    if (held_.size() < pilot_) return {};
    limit_ = spike_limit({held_.data(), pilot_}, mad_limit_);
  }
  release(false);
  return ready_;
}

std::span<const double> SpikeCleaner::finish() {
  ready_.clear();
  if (limit_ < 0) limit_ = spike_limit(held_, mad_limit_);
  release(true);
  held_.clear();
  has_before_ = false;
  return ready_;
}

void SpikeCleaner::release(bool last) {
  if (!has_before_ && !held_.empty()) {
    ready_.push_back(held_.front());  // the very first sample has no neighbour before
    has_before_ = true;
  }
  std::size_t t = 1;
  for (; t + 2 < held_.size() || (last && t < held_.size()); ++t) {
    if (limit_ > 0 && t + 1 < held_.size()) {
      const double e = std::abs(residual(held_[t - 1], held_[t], held_[t + 1]));
      const double next =
          t + 2 < held_.size() ? std::abs(residual(held_[t], held_[t + 1], held_[t + 2])) : 0.0;
      if (e > limit_ && !(next >= e)) {
        held_[t] = 0.5 * (held_[t - 1] + held_[t + 1]);
        ++count_;
      }
    }
    ready_.push_back(held_[t]);
  }
  if (t > 1)
    held_.erase(held_.begin(),
                held_.begin() + static_cast<std::ptrdiff_t>(std::min(t - 1, held_.size())));
}

std::uint64_t clean_spikes(std::span<double> record, double mad_limit) {
  SpikeCleaner cleaner = SpikeCleaner::with_limit(spike_limit(record, mad_limit));
  std::size_t written = 0;
  const auto keep = [&](std::span<const double> cleaned) {
    std::copy(
        cleaned.begin(), cleaned.end(), record.begin() + static_cast<std::ptrdiff_t>(written));
    written += cleaned.size();
  };
  constexpr std::size_t kPiece = 8192;
  for (std::size_t from = 0; from < record.size(); from += kPiece) {
    keep(cleaner.push(record.subspan(from, std::min(kPiece, record.size() - from))));
  }
  keep(cleaner.finish());
  return cleaner.count();
}

}  // namespace libchar
