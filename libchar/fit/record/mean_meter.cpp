// Two means become that of both by their weights, m1 + (m2 - m1) n2 / (n1 + n2): an offset costs no
// digits.
#include "libchar/fit/record/mean_meter.hpp"

#include <algorithm>
#include <bit>
#include <limits>
#include <stdexcept>

#include "libchar/core/numeric/present.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMostKept = std::size_t{1} << 16U;

}  // namespace

void MeanMeter::Mean::join(const Mean& later) {
  if (later.present == 0) return;
  present += later.present;
  value +=
      (later.value - value) * static_cast<double>(later.present) / static_cast<double>(present);
}

void MeanMeter::push(std::span<const double> samples) {
  while (!samples.empty()) {
    const std::size_t some = std::min<std::uint64_t>(samples.size(), per_mean_ - open_samples_);
    const PresentMean mean = present_mean(samples.first(some));
    open_.join({mean.mean, mean.count});
    open_samples_ += some;
    samples = samples.subspan(some);
    if (open_samples_ == per_mean_) close();
  }
}

void MeanMeter::close() {
  means_.push_back(open_);
  open_ = {};
  open_samples_ = 0;
  if (means_.size() == kMostKept) halve();
}

// A mean without a partner is part of the one that is open.
void MeanMeter::halve() {
  for (std::size_t i = 0; i < means_.size() / 2; ++i) {
    Mean pair = means_[2 * i];
    pair.join(means_[2 * i + 1]);
    means_[i] = pair;
  }
  if (means_.size() % 2 != 0) {
    Mean last = means_.back();
    last.join(open_);
    open_ = last;
    open_samples_ += per_mean_;
  }
  means_.resize(means_.size() / 2);
  per_mean_ *= 2;
}

void MeanMeter::join(MeanMeter later) {
  while (per_mean_ < later.per_mean_) halve();
  while (later.per_mean_ < per_mean_) later.halve();
  if (open_samples_ != 0) {  // a short part within the mean that is open
    if (!later.means_.empty() || open_samples_ + later.open_samples_ > per_mean_)
      throw std::logic_error("means joined where one straddles");
    open_.join(later.open_);
    open_samples_ += later.open_samples_;
    if (open_samples_ == per_mean_) close();
    return;
  }
  means_.insert(means_.end(), later.means_.begin(), later.means_.end());
  open_ = later.open_;
  open_samples_ = later.open_samples_;
  while (means_.size() >= kMostKept) halve();
}

void MeanMeter::scale(double factor) {
  for (Mean& mean : means_) mean.value *= factor;
  open_.value *= factor;
}

std::vector<double> MeanMeter::means() const {
  std::vector<double> out;
  out.reserve(means_.size());
  for (const Mean& mean : means_)
    out.push_back(mean.present > 0 ? mean.value : std::numeric_limits<double>::quiet_NaN());
  return out;
}

std::uint64_t MeanMeter::missing() const {
  std::uint64_t present = open_.present;
  for (const Mean& mean : means_) present += mean.present;
  return samples() - present;
}

EventSeries MeanMeter::series(double rate_hz) const {
  EventSeries series = event_series(means(), rate_hz / static_cast<double>(per_mean_), kMostKept);
  series.per_point *= per_mean_;
  return series;
}

void MeanMeter::write_state(StateWriter& to) const {
  to.number(per_mean_);
  to.number(open_samples_);
  std::vector<Mean> all = means_;
  all.push_back(open_);
  to.number(all.size());
  for (const Mean& mean : all) {
    to.real(mean.value);
    to.number(mean.present);
  }
}

void MeanMeter::read_state(StateReader& from) {
  per_mean_ = from.number();
  open_samples_ = from.number();
  means_.resize(from.count(16));
  for (Mean& mean : means_) {
    mean.value = from.real();
    mean.present = from.number();
    if (mean.present > per_mean_) from.refuse("a mean");
  }
  if (means_.empty() || means_.size() > kMostKept || !std::has_single_bit(per_mean_) ||
      open_samples_ >= per_mean_)
    from.refuse("the means of a channel");
  open_ = means_.back();
  means_.pop_back();
  if (open_.present > open_samples_) from.refuse("the means of a channel");
}

}  // namespace libchar
