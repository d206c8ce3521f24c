#include "libchar/replay/device_source.hpp"

#include <fmt/format.h>

#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/fusion/device/c_form.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/replay/detail/learnt_fusion.hpp"

namespace libchar::detail {
namespace {

/// Cycles of one operation. float: additions and multiplications take one cycle, and two for what they load and store;
/// divisions and roots 14; tanh and atan2 of a mathematical library about 200. double is computed in software.
struct Cycles {
  double sum, division, root, tanh, arctangent;
};
constexpr Cycles kM4Single{3, 16, 16, 200, 220}, kM33Single{2.5, 16, 14, 180, 200};
constexpr Cycles kM4Double{70, 450, 600, 3500, 4000}, kM33Double{60, 400, 550, 3200, 3600};
constexpr double kCall = 40;  // of a step: its call, its branches

double cycles(const fusion::CCost& cost, const Cycles& of) {
  return kCall + cost.sums * of.sum + cost.divisions * of.division + cost.roots * of.root + cost.tanhs * of.tanh +
         cost.arctangents * of.arctangent;
}

class Writer {
 public:
  Writer(const LearntFusion& learnt, const DeviceOptions& options)
      : learnt_(learnt),
        options_(options),
        algorithm_(algorithm_to_apply(learnt, options.algorithm)),
        entry_(fusion::algorithm(algorithm_.name)),
        settings_(entry_.options),
        array_(array_of(learnt)) {
    for (const auto& [name, value] : algorithm_.options) settings_.set(name, value);
    for (const LearntSensor& sensor : learnt.sensors)
      if (!sensor.left_out) sensors_.push_back(&sensor);
    array_.rate_hz = learnt.rate_hz;
  }

  DeviceSource make() {
    refuse_what_has_no_form();
    const fusion::CForm form =
        fusion::c_form({algorithm_.name, &array_, &settings_, &algorithm_.learnt, options_.single});
    DeviceSource out;
    out.algorithm = algorithm_.label;
    out.state_bytes = bytes_of(form);
    fusion::CCost cost = form.cost;
    cost.sums += 2 * static_cast<double>(sensors_.size());  // scale and offset of each sample
    cost.roots += 1;                                        // of the variance
    out.operations = cost.sums + cost.divisions + cost.roots + cost.tanhs + cost.arctangents;
    out.cycles_m4f = cycles(cost, options_.single ? kM4Single : kM4Double);
    out.cycles_m33 = cycles(cost, options_.single ? kM33Single : kM33Double);
    out.notes = form.notes;
    out.text = comment(out, cost) + head(form) + samples() + form.functions + tail(form);
    return out;
  }

 private:
  void refuse_what_has_no_form() const {
    const auto refuse = [&](const std::string& what) {
      throw usage_error("E0940", learnt_.file)
          .says("samples go through {}, which has no form in C", what)
          .hint("replay without it");
    };
    if (learnt_.average_s) refuse("means over intervals");
    if (learnt_.preparation.from_hz > 0 || learnt_.preparation.to_hz > 0) refuse("a filter");
    if (learnt_.preparation.detrend != "none") refuse("a trend of the whole log");
    for (const LearntSensor* sensor : sensors_) {
      if (sensor->alignment.delay_samples != 0) refuse("an interpolation by a delay");
      for (const double share : sensor->alignment.cross)
        if (share != 0) refuse("other axes");
    }
  }

  std::size_t bytes_of(const fusion::CForm& form) const {
    const std::size_t real = options_.single ? 4 : 8;
    std::size_t out = form.reals * real + form.words * 4 + form.bytes;
    if (out == 0) out = 4;  // one number that is not used: C99 has no empty struct
    const std::size_t whole = form.reals > 0 ? real : 4;
    return (out + whole - 1) / whole * whole;
  }

  std::string comment(const DeviceSource& out, const fusion::CCost& cost) const {
    std::string text = fmt::format(
        "/* {} with what a replay learnt, made by sensorchar {} from {}.\n"
        "   C99, no heap, no other file; {}.\n\n   Sensors, in the order of y:\n",
        algorithm_.label, version(), learnt_.file.empty() ? "a replay" : comment_words(learnt_.file),
        options_.single ? "float" : "double");
    for (const LearntSensor* sensor : sensors_)
      text +=
          fmt::format("     {}{}\n", comment_words(sensor->name),
                      sensor->recorded_unit.empty() ? std::string() : ", in " + comment_words(sensor->recorded_unit));
    text += fmt::format(
        "   Rate: {} Hz. A missing sample is NAN.\n\n"
        "   State: {} bytes. A step: {:.0f} additions and multiplications, {:.0f} divisions, {:.0f} square\n"
        "   roots, {:.0f} tanh, {:.0f} atan2 at most. Cycles of a step, estimated from these counts and not\n"
        "   measured: Cortex-M4F {:.0f}, Cortex-M33 {:.0f}{}.\n",
        brief_text(learnt_.rate_hz, 6), out.state_bytes, cost.sums, cost.divisions, cost.roots, cost.tanhs,
        cost.arctangents, out.cycles_m4f, out.cycles_m33,
        options_.single ? "" : " (double is computed in software there)");
    for (const std::string& note : out.notes) text += "   Note: " + note + ".\n";
    for (const Finding& finding : learnt_.findings)
      if (finding.severity != Severity::note)
        text += fmt::format("   {}: {}{}{}.\n", name_of(finding.severity), comment_words(finding.subject),
                            finding.subject.empty() ? "" : ": ", comment_words(finding.sentence));
    return text + "*/\n";
  }

  // Nothing that ends a comment, nor a line break.
  static std::string comment_words(const std::string& words) {
    std::string out = printable(words, 80);
    for (std::size_t at = out.find("*/"); at != std::string::npos; at = out.find("*/")) out[at] = '.';
    return out;
  }

  std::string head(const fusion::CForm& form) const {
    const bool f = options_.single;
    return fmt::format(
        "#include <float.h>\n#include <math.h>\n#include <stdint.h>\n\n#define N {}\n"
        "#define R(constant) {}\n#define LARGEST {}\n#define EPSILON {}\n#define FABS {}\n"
        "#define ROUND {}\n#define TANH {}\n#define ATAN2 {}\n#define SQRT {}\n\n"
        "typedef {} fusion_real;\ntypedef struct {{\n{}}} fusion_state;\n\n"
        "void fusion_init(fusion_state *s);\n"
        "/* 1: *x is the estimate and *sd its standard deviation (below zero: not known); 0: none. */\n"
        "int fusion_step(fusion_state *s, const fusion_real y[N], fusion_real *x, fusion_real *sd);\n\n"
        "static int usable(fusion_real sample) {{ return FABS(sample) <= LARGEST; }}\n\n",
        sensors_.size(), f ? "constant##f" : "constant", f ? "1e30f" : "1e100", f ? "FLT_EPSILON" : "DBL_EPSILON",
        f ? "fabsf" : "fabs", f ? "roundf" : "round", f ? "tanhf" : "tanh", f ? "atan2f" : "atan2",
        f ? "sqrtf" : "sqrt", f ? "float" : "double", form.state.empty() ? "  uint32_t none;\n" : form.state);
  }

  /// From the numbers of the log to those that are fused.
  std::string samples() const {
    std::string scale, offset, bias, gain;
    for (const LearntSensor* s : sensors_) {
      const char* comma = scale.empty() ? "" : ", ";
      const auto number = [&](double v) { return comma + fusion::c_number(v, options_.single); };
      scale += number(s->scale);
      offset += number(s->offset);
      bias += number(s->alignment.bias);
      gain += number(1 + s->alignment.gain);
    }
    const auto row = [](const char* name, const std::string& values) {
      return fmt::format("static const fusion_real {}[N] = {{{}}};\n", name, values);
    };
    std::string out = row("scale_of", scale) + row("offset_of", offset);
    if (aligned()) out += row("bias_of", bias) + row("gain_of", gain);
    return out;
  }

  bool aligned() const { return !learnt_.interpolation.empty(); }

  std::string limits() const {
    std::string out;
    for (std::size_t i = 0; aligned() && i < sensors_.size(); ++i) {
      const LearntAlignment& a = sensors_[i]->alignment;
      if (!a.low.empty() && a.low[0] > -kNoLimit)
        out += fmt::format("  if (samples[{}] <= {}) samples[{}] = 2 * LARGEST;\n", i,
                           fusion::c_number(a.low[0], options_.single), i);
      if (!a.high.empty() && a.high[0] < kNoLimit)
        out += fmt::format("  if (samples[{}] >= {}) samples[{}] = 2 * LARGEST;\n", i,
                           fusion::c_number(a.high[0], options_.single), i);
    }
    return out;
  }

  std::string tail(const fusion::CForm& form) const {
    const std::string align =
        aligned() ? limits() +
                        "  for (i = 0; i < N; ++i)\n"
                        "    if (usable(samples[i])) samples[i] = (samples[i] - bias_of[i]) / gain_of[i];\n"
                  : "";
    return "\nvoid fusion_init(fusion_state *s) {\n  static const fusion_state zero = {0};\n  *s = zero;\n" +
           form.start +
           "}\n\nint fusion_step(fusion_state *s, const fusion_real y[N], fusion_real *x, fusion_real *sd) {\n"
           "  fusion_real samples[N], variance = -1;\n  int i, given;\n"
           "  for (i = 0; i < N; ++i) samples[i] = y[i] * scale_of[i] - offset_of[i];\n" +
           align + "  given = estimate(s, samples, x, &variance);\n  *sd = given && variance >= 0 ? " + deviation() +
           " : -1;\n" + measured_deviation() + "  return given;\n}\n";
  }

  /// As `fuse` states it.
  std::string deviation() const {
    const auto number = [&](double v) { return fusion::c_number(v, options_.single); };
    const double factor = algorithm_.sd_factor.size() == 1 ? algorithm_.sd_factor[0] : 1;
    const std::string more = common_variance();
    return more.empty() ? number(factor) + " * SQRT(variance)"
                        : fmt::format("SQRT({} * variance{})", number(factor * factor), more);
  }

  /// Of the level and of the gain that all sensors share, to be added.
  std::string common_variance() const {
    const auto number = [&](double v) { return fusion::c_number(v, options_.single); };
    const LearntInput& input = learnt_.inputs[0];
    std::string out;
    if (input.level_sd) out += " + " + number(*input.level_sd * *input.level_sd);
    if (input.gain_sd) {
      const std::string away = fmt::format("(*x - {})", number(input.gain_about.value_or(0)));
      out += fmt::format(" + {} * {} * {}", number(*input.gain_sd * *input.gain_sd), away, away);
    }
    return out;
  }

  /// Of a method that states none.
  std::string measured_deviation() const {
    if (algorithm_.sd.size() != 1) return "";
    return fmt::format(
        "  for (i = 0; i < N && usable(samples[i]); ++i) {{\n  }}\n  if (given && variance < 0 && i == N) *sd = "
        "SQRT({}{});\n",
        fusion::c_number(algorithm_.sd[0] * algorithm_.sd[0], options_.single), common_variance());
  }

  const LearntFusion& learnt_;
  const DeviceOptions& options_;
  const LearntAlgorithm& algorithm_;
  const fusion::Entry& entry_;
  fusion::Settings settings_;
  fusion::Array array_;
  std::vector<const LearntSensor*> sensors_;
};

}  // namespace

DeviceSource device_source(const LearntFusion& learnt, const DeviceOptions& options) {
  return Writer(learnt, options).make();
}

const LearntAlgorithm& algorithm_to_apply(const LearntFusion& learnt, const std::string& label) {
  const std::string& wanted = label.empty() ? learnt.recommended : label;
  if (wanted.empty())
    throw usage_error("E0932", learnt.file)
        .says("the replay recommended no algorithm")
        .hint("choose one with `algorithm`: " + first_names(learnt.labels()));
  const LearntAlgorithm* found = learnt.find(wanted);
  if (found == nullptr) {
    const auto near = nearest(wanted, learnt.labels());
    throw usage_error("E0932", learnt.file)
        .says("the replay ran no algorithm of this name")
        .got(wanted)
        .hint(did_you_mean(near, "it ran " + first_names(learnt.labels())));
  }
  if (!found->refused.empty()) throw usage_error("E0933", learnt.file).says(found->refused).got(wanted);
  return *found;
}

}  // namespace libchar::detail
