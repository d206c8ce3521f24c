// The sensor-model file, written by hand: a YAML library prints 200 for 200.0 and
// 0.33333333333333331 for a third, and a number such as 1e-05 is text to YAML 1.1 readers. Every
// number here has a decimal point and reads back to the same double.

#include "libchar/model/model_file.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "libchar/core/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/core/version.hpp"

namespace libchar {
namespace {

std::string number(double value) {
  return std::isfinite(value) ? shortest_yaml(value) : "null";
}

struct TermText {
  const char* meaning;
  const char* curve;
};
constexpr std::array<TermText, kTerms> kTexts = {{
    {"white noise (angle or velocity random walk): root of the two-sided density",
     "Allan deviation value / sqrt(tau)"},
    {"bias instability: flicker (1/f) noise; not the minimum of the Allan curve",
     "Allan deviation 0.6643 value, flat"},
    {"random walk of the bias: root of its two-sided driving density",
     "Allan deviation value sqrt(tau / 3)"},
    {"quantization noise of the integrated output", "Allan deviation sqrt(3) value / tau"},
    {"rate ramp: a linear drift", "Allan deviation value tau / sqrt(2)"},
}};

std::string status_comment(Status status) {
  switch (status) {
    case Status::detected:
      return "";
    case Status::not_detected:
      return "  # no value: only an upper limit is known";
    case Status::undetermined:
      return "  # undetermined: the record cannot tell it from another term, or contradicts it";
    case Status::given:
      return "  # stated, not fitted";
    case Status::not_fitted:
      return "  # not part of the model that was fitted";
  }
  return "";
}

std::string term_block(const Coefficient& c, std::size_t t, const std::string& unit) {
  const TermName& name = kTermNames[t];
  std::string out = fmt::format("{}:  # {} here, {} in IEEE 952: {}; {}\n",
                                name.key,
                                name.letter,
                                name.ieee,
                                kTexts[t].meaning,
                                kTexts[t].curve);
  out += fmt::format("  value: {}\n", c.value ? number(*c.value) : "null");
  out += fmt::format("  unit: {}\n", quoted_yaml(term_unit(name.key, unit)));
  if (c.value && (c.status != Status::given || c.ci95.high > 0)) {
    out +=
        fmt::format("  ci95: [{}, {}]\n  ci95_by: {}\n",
                    number(c.ci95.low),
                    number(c.ci95.high),
                    c.profile ? "profile  # likelihood" : "covariance  # of the fit, log-normal");
  } else {
    out += "  ci95: null\n";
  }
  if (!c.value && c.upper95)
    out += fmt::format("  upper95: {}  # one-sided upper 95 % limit\n", number(*c.upper95));
  return out + fmt::format("  status: {}{}\n", name_of(c.status), status_comment(c.status));
}

std::string optional_line(const char* key,
                          const std::optional<double>& value,
                          const std::string& comment) {
  return value ? fmt::format("{}: {}  # {}\n", key, number(*value), comment) : std::string();
}

// One line of a map in flow style, only what differs from the identity.
std::string flow(const char* key,
                 const std::vector<std::pair<const char*, double>>& values,
                 const std::string& comment) {
  std::string inside;
  for (const auto& [name, value] : values)
    inside += fmt::format("{}{}: {}", inside.empty() ? "" : ", ", name, number(value));
  return fmt::format("{}: {{{}}}  # {}\n", key, inside, comment);
}

std::string sampling_block(const SensorModel& m) {
  const bool limited = m.noise_sampling == NoiseSampling::band_limited;
  std::string out = fmt::format(
      "noise_sampling: {}\n",
      limited
          ? "band-limited  # continuous white noise, low-passed before sampling: aliases included"
          : "per-sample  # noise is made at rate_hz, then low-passed with the signal");
  if (m.noise_start == NoiseStart::zero)
    out += "noise_start: zero  # flicker starts at the first sample\n";
  if (m.flicker_method != "recursive") out += fmt::format("flicker_method: {}\n", m.flicker_method);
  out +=
      optional_line("white_hold_s", m.white_hold_s, "white noise is renewed this often and held");
  out += optional_line("flicker_hold_s", m.flicker_hold_s, "flicker is made at this step and held");
  return out;
}

std::string deterministic_blocks(const SensorModel& m, const std::string& u) {
  std::string out;
  if (m.scale_factor != ScaleFactor{})
    out += flow("scale_factor",
                {{"value", m.scale_factor.value},
                 {"spread", m.scale_factor.spread},
                 {"tc1_per_k", m.scale_factor.tc1_per_k},
                 {"tc2_per_k2", m.scale_factor.tc2_per_k2}},
                "N(value, spread) a device, times 1 + tc1 dT + tc2 dT^2");
  if (m.nonlinearity != Nonlinearity{})
    out += flow("nonlinearity",
                {{"quadratic", m.nonlinearity.quadratic},
                 {"quadratic_tc_per_k", m.nonlinearity.quadratic_tc_per_k},
                 {"cubic", m.nonlinearity.cubic},
                 {"cubic_tc_per_k", m.nonlinearity.cubic_tc_per_k}},
                "of the input x: quadratic (1 + tc dT) x^2 + cubic (1 + tc dT) x^3");
  if (m.bias != Bias{})
    out += flow("bias",
                {{"value", m.bias.value},
                 {"spread", m.bias.spread},
                 {"tc1_per_k", m.bias.tc1_per_k},
                 {"tc2_per_k2", m.bias.tc2_per_k2}},
                "N(value, spread) a device, plus tc1 dT + tc2 dT^2, in " + u);
  if (m.reference_temperature_degc != 25)
    out += fmt::format("reference_temperature_degc: {}\n", number(m.reference_temperature_degc));
  return out;
}

std::string sensitivity_line(const SensorModel& m) {
  if (m.sensitivity == Sensitivity{}) return "";
  return fmt::format("sensitivity: {{gain: {}, unit: {}}}  # output = gain times the above\n",
                     number(m.sensitivity.gain),
                     m.sensitivity.unit.empty() ? "null" : quoted_yaml(m.sensitivity.unit));
}

std::string provenance_block(const SensorModel& m) {
  std::string out =
      fmt::format("obtained: {}\nmethod: {}\n", quoted_yaml(m.obtained), quoted_yaml(m.method));
  out += fmt::format("recording:\n  file: {}\n  sha256: {}\n  duration_s: {}\n",
                     quoted_yaml(m.recording_file),
                     quoted_yaml(m.recording_sha256),
                     number(m.duration_s));
  if (m.tau_max_s > 0) {
    out += fmt::format(
        "valid_tau_s: [{}, {}]  # averaging times, in seconds, that the recording covers "
        "reliably\n",
        number(m.tau_min_s),
        number(m.tau_max_s));
  }
  return out;
}

}  // namespace

std::string model_yaml(const SensorModel& m) {
  const std::string unit = m.unit.empty() ? "U" : m.unit;
  const std::string u = printable(unit);
  std::string out = fmt::format(
      "# Noise of one sensor channel. Long keys name each term; a bare Q is white noise here and "
      "quantization in IEEE 952.\n"
      "format: sensor-model\nversion: 1\ntool: {{name: sensorchar, version: {}}}\nchannel: "
      "{}\nunit: {}\n",
      quoted_yaml(version()),
      quoted_yaml(m.channel),
      m.unit.empty() ? "null  # the log names none: U below" : quoted_yaml(m.unit));
  if (!m.kind.empty()) out += fmt::format("kind: {}\n", quoted_yaml(m.kind));
  if (!m.axis.empty()) out += fmt::format("axis: {}\n", m.axis);
  out += fmt::format(
      "rate_hz: {}\nsampling: point  # samples at an instant, not averages over the sampling "
      "interval\n",
      number(m.rate_hz));
  out +=
      "density: two-sided  # a data sheet's noise density is one-sided: sqrt(2) times "
      "white_noise\n\n";
  for (std::size_t t = 0; t < kTerms; ++t) out += term_block(m.noise[t], t, unit);
  out += sampling_block(m) + "\n" + deterministic_blocks(m, u);
  out += optional_line(
      "bandwidth_hz", m.bandwidth_hz, "corner of a first-order low-pass behind the noise");
  if (m.saturation_low && m.saturation_high) {
    out += fmt::format("saturation: [{}, {}]  # ends of the range, in {}\n",
                       number(*m.saturation_low),
                       number(*m.saturation_high),
                       u);
  }
  out += sensitivity_line(m);
  out += optional_line("resolution",
                       m.resolution,
                       "least step between two values of the output, in " +
                           (m.sensitivity.unit.empty() ? u : printable(m.sensitivity.unit)));
  out += fmt::format(
      "mean: {}  # of the recording, in {}; holds the true input at rest as well as the bias\n\n",
      number(m.mean),
      u);
  out += provenance_block(m);
  if (!m.remarks.empty()) {
    out += "remarks:\n";
    for (const std::string& remark : m.remarks) out += "  - " + quoted_yaml(remark) + "\n";
  }
  return out;
}

}  // namespace libchar
