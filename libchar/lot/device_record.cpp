#include "libchar/lot/device_record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/compare/runs.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/error.hpp"
#include "libchar/core/file/log_files.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"

namespace libchar {

DeviceQuantity quantity_of(Term term) { return static_cast<DeviceQuantity>(term); }

std::optional<Term> term_of(DeviceQuantity quantity) {
  const auto at = static_cast<std::size_t>(quantity);
  return at < kTerms ? std::optional(static_cast<Term>(at)) : std::nullopt;
}

bool in_logarithm(DeviceQuantity quantity) { return quantity < DeviceQuantity::turn_on_bias; }

std::string title_of(DeviceQuantity quantity) {
  if (const auto term = term_of(quantity)) return term_title(*term);
  switch (quantity) {
    case DeviceQuantity::gauss_markov_sigma:
      return "Gauss–Markov deviation";
    case DeviceQuantity::gauss_markov_time:
      return "Gauss–Markov time";
    case DeviceQuantity::turn_on_bias:
      return "Turn-on bias";
    default:
      return "Temperature coefficient";
  }
}

std::string unit_of(DeviceQuantity quantity, std::string_view channel_unit) {
  const std::string unit = channel_unit.empty() ? "U" : std::string(channel_unit);
  if (term_of(quantity)) return term_unit(name_of(quantity), unit);
  if (quantity == DeviceQuantity::gauss_markov_time) return "s";
  return quantity == DeviceQuantity::temperature_coefficient ? unit + "/K" : unit;
}

namespace {

bool same_number(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

/// Where the model that is reported has all terms and the term is well known, its square is that of
/// the value, and hardly skew.
bool says_more(const Coefficient& c) {
  constexpr double kSame = 1e-6, kWellKnown = 0.05;
  if (!c.in_all || !(c.in_all->sd > 0) || !std::isfinite(c.in_all->sd) || !std::isfinite(c.in_all->square) ||
      !std::isfinite(c.in_all->skewness))
    return false;
  const double square = c.value.value_or(0) * c.value.value_or(0);
  return c.status != Status::detected || c.relative_sd > kWellKnown ||
         std::abs(c.in_all->square - square) > kSame * square;
}

RecordedValue recorded(DeviceQuantity quantity, const Coefficient& c) {
  RecordedValue out;
  out.quantity = quantity;
  out.status = c.status;
  if (c.value) {
    out.value = *c.value;
    out.ci95 = c.ci95;
    out.sd = c.relative_sd;
  }
  if (c.upper95) out.upper95 = *c.upper95;
  if (says_more(c)) out.in_all = c.in_all;
  return out;
}

RecordedValue turn_on_bias(const ChannelResult& channel, const NoiseFit& fit) {
  RecordedValue out;
  out.quantity = DeviceQuantity::turn_on_bias;
  out.value = channel.quality.mean;
  out.sd = std::sqrt(mean_noise_variance(fit));
  out.ci95 = {out.value - kNormal95 * out.sd, out.value + kNormal95 * out.sd};
  return out;
}

RecordedValue temperature_coefficient(const TemperatureEffect& effect) {
  RecordedValue out;
  out.quantity = DeviceQuantity::temperature_coefficient;
  if (effect.order == 0) {
    out.status = Status::not_detected;
    return out;
  }
  if (effect.like_drift) out.status = Status::undetermined;
  out.value = effect.coefficient[0];
  out.ci95 = effect.ci95;
  // Of the interval, which knows that the lag is estimated too.
  const double width = effect.ci95.high - effect.ci95.low;
  out.sd = std::isfinite(width) && width > 0 ? width / (2 * kNormal95) : effect.sd;
  return out;
}

RecordedChannel channel_record(const ChannelResult& channel, SampleKind data) {
  RecordedChannel out;
  out.name = channel.channel.name;
  out.unit = channel.channel.unit;
  out.samples = channel.quality.samples;
  out.missing = channel.quality.missing;
  if (std::isfinite(channel.quality.mean)) out.mean = channel.quality.mean;
  out.findings = judge(channel).findings;
  if (!channel.fit) return out;
  const NoiseFit& fit = *channel.fit;
  out.fitted = true;
  out.rate_hz = fit.rate_hz;
  out.duration_s = fit.duration_s;
  out.p = fit.goodness.p;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].status != Status::not_fitted)
      out.values.push_back(recorded(quantity_of(static_cast<Term>(t)), fit.term[t]));
  if (fit.gauss_markov && fit.gauss_markov->in_model) {
    out.values.push_back(recorded(DeviceQuantity::gauss_markov_sigma, fit.gauss_markov->sigma));
    out.values.push_back(recorded(DeviceQuantity::gauss_markov_time, fit.gauss_markov->tau_s));
  }
  if (data == SampleKind::rate) out.values.push_back(turn_on_bias(channel, fit));
  if (fit.temperature) out.values.push_back(temperature_coefficient(*fit.temperature));
  return out;
}

/// What moves a thermometer is what it measures.
void drop_own_effects(RecordedChannel& thermometer) {
  std::erase_if(thermometer.values, [](const RecordedValue& v) {
    return v.quantity == DeviceQuantity::turn_on_bias || v.quantity == DeviceQuantity::temperature_coefficient;
  });
}

bool is_in_celsius(const std::string& text) {
  const auto unit = find_unit(text);
  return unit && unit->symbol == "°C";
}

/// The one channel in °C beside others.
void use_thermometer(DeviceRecord& record) {
  RecordedChannel* thermometer = nullptr;
  for (RecordedChannel& channel : record.channels) {
    if (!is_in_celsius(channel.unit)) continue;
    if (thermometer != nullptr) return;  // which of them is that of the sensor?
    thermometer = &channel;
  }
  if (thermometer == nullptr || record.channels.size() < 2) return;
  drop_own_effects(*thermometer);
  if (!record.temperature_c && std::isfinite(thermometer->mean)) record.temperature_c = thermometer->mean;
}

}  // namespace

bool RecordedValue::operator==(const RecordedValue& o) const {
  return quantity == o.quantity && status == o.status && same_number(value, o.value) &&
         same_number(ci95.low, o.ci95.low) && same_number(ci95.high, o.ci95.high) && same_number(sd, o.sd) &&
         same_number(upper95, o.upper95) && in_all == o.in_all;
}

bool RecordedChannel::operator==(const RecordedChannel& o) const {
  return name == o.name && unit == o.unit && rate_hz == o.rate_hz && duration_s == o.duration_s &&
         samples == o.samples && missing == o.missing && same_number(mean, o.mean) && fitted == o.fitted &&
         same_number(p, o.p) && values == o.values && findings == o.findings;
}

const RecordedValue* RecordedChannel::find(DeviceQuantity quantity) const {
  for (const RecordedValue& v : values)
    if (v.quantity == quantity) return &v;
  return nullptr;
}

bool RecordedChannel::is_spoilt(DeviceQuantity quantity) const {
  const bool bias = quantity == DeviceQuantity::turn_on_bias;
  const std::optional<Term> term = term_of(quantity);
  const auto concerns = [&](const Finding::Effect& effect) {
    switch (effect.quantity) {
      case Affected::values:
      case Affected::scale:
        return true;
      case Affected::mean:
        return bias;
      case Affected::time:
      case Affected::rate:
      case Affected::noise:
        return !bias;
      case Affected::white:
        return term == Term::white;
      case Affected::flicker:
        return term == Term::flicker;
      case Affected::walk:
        return term == Term::walk;
      case Affected::weights:
      case Affected::verdict:
        break;
    }
    return false;
  };
  return std::any_of(findings.begin(), findings.end(), [&](const Finding& one) {
    return one.severity == Severity::bad && std::any_of(one.effects.begin(), one.effects.end(), concerns);
  });
}

DeviceRecord record_of(const Characterization& result, SampleKind data) {
  DeviceRecord out;
  out.log = result.log.file;
  out.sha256 = result.log.sha256;
  out.program = version();
  if (result.limits) out.limits = result.limits->verdict;
  out.findings = result.log.warnings.list();
  for (const ChannelResult& channel : result.channels) {
    out.channels.push_back(channel_record(channel, data));
    if (result.temperature && channel.channel.name == result.temperature->name) drop_own_effects(out.channels.back());
    if (channel.fit && channel.fit->temperature && is_in_celsius(channel.fit->temperature->unit))
      out.temperature_c = channel.fit->temperature->mean;
  }
  use_thermometer(out);
  return out;
}

std::vector<DeviceRecord> records_of(std::span<const Characterization> results, SampleKind data) {
  refuse_same_recording(results);
  std::vector<std::string> files;
  for (const Characterization& one : results) files.push_back(one.log.file);
  const std::vector<std::string> names = names_of_logs(files);
  std::vector<DeviceRecord> out;
  for (std::size_t i = 0; i < results.size(); ++i) {
    DeviceRecord& record = out.emplace_back(record_of(results[i], data));
    record.device = names[i];
    finish_record(record);
  }
  return out;
}

void finish_record(DeviceRecord& record) {
  use_thermometer(record);
  if (std::string why = why_nothing_fitted(record); !why.empty()) {
    record.problem = std::move(why);
    for (const RecordedChannel& channel : record.channels)
      record.findings.insert(record.findings.end(), channel.findings.begin(), channel.findings.end());
    record.channels.clear();
  }
}

std::string why_nothing_fitted(const DeviceRecord& record) {
  if (!record.problem.empty()) return "";
  for (const RecordedChannel& channel : record.channels)
    if (channel.fitted) return "";
  Problem problem{ErrorKind::numeric, "E0711", record.log, "no channel could be fitted"};
  if (!record.channels.empty() && !record.channels[0].findings.empty())
    problem.what += fmt::format("; {}: {}", record.channels[0].name, record.channels[0].findings[0].sentence);
  return one_line(problem);
}

Coefficient coefficient_of(const RecordedValue& v, double factor) {
  Coefficient out;
  out.status = v.status;
  if (!std::isnan(v.value)) {
    out.value = factor * v.value;
    out.ci95 = {factor * v.ci95.low, factor * v.ci95.high};
    out.relative_sd = v.sd;
  }
  if (v.in_all) out.in_all = {factor * factor * v.in_all->square, factor * factor * v.in_all->sd, v.in_all->skewness};
  if (!std::isnan(v.upper95)) out.upper95 = factor * v.upper95;
  return out;
}

}  // namespace libchar
