#include "libchar/log/quality.hpp"

#include <fmt/format.h>

#include "libchar/core/error.hpp"
#include "libchar/core/moments.hpp"

namespace libchar {

struct QualityMeter::State {
  Moments moments;
};

QualityMeter::QualityMeter() : state_(std::make_unique<State>()) {}
QualityMeter::~QualityMeter() = default;
QualityMeter::QualityMeter(QualityMeter&&) noexcept = default;
QualityMeter& QualityMeter::operator=(QualityMeter&&) noexcept = default;

void QualityMeter::push(std::span<const double> samples) {
  state_->moments.push(samples);
}

ChannelQuality QualityMeter::finish() const {
  ChannelQuality q;
  q.samples = state_->moments.count();
  q.missing = state_->moments.missing();
  q.mean = state_->moments.mean();
  q.standard_deviation = state_->moments.standard_deviation();
  q.minimum = state_->moments.minimum();
  q.maximum = state_->moments.maximum();
  return q;
}

void quality_warnings(const Channel& channel, const ChannelQuality& quality, Warnings& warnings) {
  if (quality.samples >= 16 && quality.distinct_values > 1 && quality.distinct_values <= 3)
    warnings.add("quantization_limited",
                 fmt::format("{} has {} distinct values: limited by its resolution",
                             channel.name,
                             quality.distinct_values));
}

void require_samples(const LogInfo& info, std::uint64_t needed, const std::string& purpose) {
  if (info.samples >= needed) return;
  throw Error({ErrorKind::numeric,
               "E0401",
               info.first_line > 0 ? fmt::format("{}:{}:1", info.file, info.first_line) : info.file,
               fmt::format("{} sample{}, {} needs at least {}",
                           info.samples,
                           info.samples == 1 ? "" : "s",
                           purpose,
                           needed),
               "",
               ""});
}

}  // namespace libchar
