#include "libchar/fusion/device/c_form.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/fusion/algorithm.hpp"
#include "libchar/fusion/detail/bias/bias_filter.hpp"
#include "libchar/fusion/detail/device/c_steps.hpp"
#include "libchar/fusion/detail/variances/reweighted_variances.hpp"

namespace libchar::fusion {
namespace {

constexpr std::array<std::string_view, 12> kInC{"mean",
                                                "inverse-variance",
                                                "minque",
                                                "virtual-sensor",
                                                "least-squares",
                                                "least-squares-published",
                                                "shrunk-least-squares",
                                                "non-negative-least-squares",
                                                "perceptron",
                                                "tilt-gyroscope",
                                                "tilt-complementary",
                                                "tilt-complementary-tuned"};

Refusal no_form(const CChoice& choice, const std::string& why) {
  return usage_error("E0940")
      .says("{} has no form in C{}", choice.algorithm, why)
      .hint("these have one: {}", fmt::join(kInC, ", "));
}

/// Numbers of a learnt list; the file was checked when it was read by `fuse`, here by its length alone.
const std::vector<double>& learnt_list(const CChoice& choice, std::string_view name, std::size_t wanted) {
  for (const LearntNumbers& numbers : *choice.learnt)
    if (numbers.name == name && numbers.values.size() == wanted) return numbers.values;
  throw input_error("E0866").says("learnt.{}: is missing, or not {} numbers as this array has", name, wanted);
}

double learnt_number(const CChoice& choice, std::string_view name) { return learnt_list(choice, name, 1)[0]; }

using Replacements = std::vector<std::pair<std::string_view, std::string>>;

std::string replaced(std::string text, const Replacements& with) {
  for (const auto& [from, to] : with)
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  return text;
}

std::string step(std::string_view text, const Replacements& with) { return replaced(fmt::format("\n{}", text), with); }

class Maker {
 public:
  explicit Maker(const CChoice& choice) : choice_(choice), n_(static_cast<std::size_t>(choice.array->channels)) {}

  CForm make() {
    if (std::find(kInC.begin(), kInC.end(), choice_.algorithm) == kInC.end()) throw no_form(choice_, "");
    if (!choice_.array->tilt && !choice_.array->one_common_input())
      throw no_form(choice_, " for sensors that see several inputs, or one unlike each other");
    const Settings& settings = *choice_.settings;
    for (const Option& option : settings.table())
      if (option.name == "fault_detection" && choice_.algorithm != "minque" && settings["fault_detection"] != 0)
        throw no_form(choice_, " with fault detection before it");
    if (choice_.algorithm == "mean") return weighted(true);
    if (choice_.algorithm == "inverse-variance") return weighted(false);
    if (choice_.algorithm == "minque") return minque();
    if (choice_.algorithm == "virtual-sensor") return virtual_sensor();
    if (choice_.algorithm == "perceptron") return perceptron();
    if (choice_.algorithm.starts_with("tilt")) return tilt();
    return least_squares();
  }

 private:
  std::string number(double value) const { return c_number(value, choice_.single); }
  std::string table(std::string_view name, const double* values, std::size_t count) const {
    std::string out = fmt::format("static const fusion_real {}[{}] = {{", name, count);
    for (std::size_t i = 0; i < count; ++i)
      out += fmt::format("{}{}", i == 0 ? "\n  " : i % 6 == 0 ? ",\n  " : ", ", number(values[i]));
    return out + "};\n";
  }
  std::string table(std::string_view name, const std::vector<double>& values) const {
    return table(name, values.data(), values.size());
  }

  CForm weighted(bool alike);
  CForm least_squares();
  CForm minque();
  CForm virtual_sensor();
  CForm perceptron();
  CForm tilt();
  std::string epochs(BiasFilter& filter, const Eigen::VectorXd& samples) const;

  const CChoice& choice_;
  std::size_t n_;
};

CForm Maker::weighted(bool alike) {
  const Eigen::VectorXd& levels = choice_.array->noise_levels;
  const auto n = static_cast<double>(n_);
  std::vector<double> weights(n_, 1 / n), variances(n_, -1);
  if (levels.size() == choice_.array->channels) std::copy(levels.begin(), levels.end(), variances.begin());
  double variance = variances[0] > 0 ? levels.sum() / (n * n) : -1;
  if (!alike) {
    const double smallest = levels.minCoeff();
    const Eigen::VectorXd w = (smallest / levels.array()).matrix();
    for (std::size_t i = 0; i < n_; ++i) weights[i] = w[static_cast<Eigen::Index>(i)] / w.sum();
    variance = smallest / w.sum();
  }
  CForm out;
  out.functions = (alike ? "" : table("weight", weights)) + (alike ? table("level", variances) : "") +
                  step(alike ? mean_in_c() : weighted_in_c(), {{"VARIANCE", number(variance)}});
  out.cost.sums = alike ? 2 * n : 3 * n;
  out.cost.divisions = 1;
  return out;
}

CForm Maker::least_squares() {
  const std::vector<double>& gain = learnt_list(choice_, "gains", n_);
  const std::vector<double>& bias = learnt_list(choice_, "biases", n_);
  const std::vector<double>& weight = learnt_list(choice_, "weights", n_);
  std::vector<double> direct(n_);
  double total = 0, shift = 0, all = 0;
  Eigen::VectorXd d(choice_.array->channels), b(d.size());
  for (std::size_t i = 0; i < n_; ++i) {
    d[static_cast<Eigen::Index>(i)] = direct[i] = weight[i] / gain[i];
    b[static_cast<Eigen::Index>(i)] = bias[i];
    all += weight[i];
  }
  total = d.sum();
  shift = d.dot(b);
  const bool plain = std::all_of(gain.begin(), gain.end(), [](double g) { return g == 1; });
  if (plain && std::abs(total - 1) < 1e-12) total = 1;
  CForm out;
  out.functions = table("direct", direct) + table("gain", gain) + table("bias", bias) + table("weight", weight) +
                  step(least_squares_in_c(), {{"TOTAL", number(total)},
                                              {"SHIFT", number(learnt_number(choice_, "constant") - shift)},
                                              {"CONSTANT", number(learnt_number(choice_, "constant"))},
                                              {"ALL", number(all)},
                                              {"VARIANCE", number(learnt_number(choice_, "variance"))}});
  out.cost.sums = 3 * static_cast<double>(n_) + 3;
  return out;
}

constexpr const char* kMinqueState =
    R"(  fusion_real v[N], inverse[N], r[N], p[N], shown[N], gathered[N], moment[N], work[N];
  fusion_real first[16 * N];
  fusion_real fused, stated, x, rounding, gathered_gain, last_gain, gathered_rounding;
  uint32_t index[N], present[N], calm[N];
  uint32_t m, use, instants, gathered_instants, first_instants, started, count_out, not_begun, now;
  unsigned char out[N];
)";

constexpr const char* kMinqueStart = R"(  {
    int i;
    for (i = 0; i < N; ++i) {
      s->v[i] = START;
      s->inverse[i] = 1 / START;
      s->shown[i] = 1;
      s->moment[i] = -1;
      s->present[i] = (uint32_t)i;
      s->index[i] = (uint32_t)N;
    }
    s->use = N;
    s->not_begun = N;
    s->fused = 1;
    s->stated = 1;
    s->started = STARTED;
    s->last_gain = LASTING;
  }
)";

CForm Maker::minque() {
  const Settings& s = *choice_.settings;
  if (n_ < 3) throw no_form(choice_, " for fewer than three sensors");
  CForm out;
  const auto n = static_cast<double>(n_);
  const bool shorter = 1 - s["fault_gamma"] >= 5 * (1 - s["gamma"]);
  const bool watches = s["fault_detection"] != 0 && shorter;
  if (s["fault_detection"] == 1)
    out.notes.emplace_back(
        "faults are found by the second moment (minque.fault_detection = 2), not by cumulative sums, which have no "
        "form in C");
  const double armed =
      std::max(static_cast<double>(choice_.array->fault_free_samples), std::ceil(1 / (1 - s["gamma"])));
  const double start = s["start_variance"];
  out.state = kMinqueState;
  out.start = replaced(kMinqueStart, {{"STARTED", start > 0 ? "1" : "0"},
                                      {"START", number(start > 0 ? start : 1)},
                                      {"LASTING", number(1 - s["gamma"])}});
  out.functions = step(minque_in_c(), {{"FORGETS", start > 0 ? "1" : "0"},
                                       {"LASTING", number(1 - s["gamma"])},
                                       {"MEMORY", number(std::sqrt(1 - s["gamma"]))},
                                       {"DAMPING", number(s["damping"])},
                                       {"NOISE_OF_ROUNDING", number(1e4)},
                                       {"LEAST_RATIO", number(1e-26)},
                                       {"LEAST_RIDGE", number(kLeastRidge)},
                                       {"FLOOR_LARGEST", number(std::max(s["floor_largest"], 1e-26))},
                                       {"FLOOR", number(s["floor"])},
                                       {"TINY", number(choice_.single ? 1e-36 : 1e-280)},
                                       {"SMALLEST_SHARE", number(choice_.single ? 1e-6 : 1e-12)},
                                       {"WATCHES", watches ? "1" : "0"},
                                       {"FAULT_GAIN", number(1 - s["fault_gamma"])},
                                       {"THRESHOLD", number(s["fault_threshold"])},
                                       {"RECOVERY", fmt::format("{:.0f}u", std::min(s["recovery_samples"], 4e9))},
                                       {"ARMED", fmt::format("{:.0f}u", std::min(armed, 4e9))}});
  out.reals = 8 * n_ + 16 * n_ + 7;
  out.words = 3 * n_ + 9;
  out.bytes = n_;
  // Weighing, residuals, moments; the renewal of the variances once in 16 instants or sooner.
  out.cost.sums = 12 * n + (27 * n + 22);
  out.cost.divisions = n + 3 * n + 6;
  return out;
}

/// Variances of the estimate, and the instants from which on they hold.
std::string Maker::epochs(BiasFilter& filter, const Eigen::VectorXd& samples) const {
  const std::size_t count = filter.epoch_at(1e300) + 1;
  std::string since = fmt::format("static const uint32_t since[{}] = {{", count);
  std::vector<double> variances;
  double instant = 0;
  for (std::size_t k = 0; k < count; ++k) {
    // The first instant of the epoch: doubled until it is behind, then halved in.
    double low = instant, high = instant;
    while (filter.epoch_at(high) < k) high = 2 * high + 1;
    while (high - low > 1) {
      const double middle = std::floor(low + (high - low) / 2);
      (filter.epoch_at(middle) < k ? low : high) = middle;
    }
    instant = filter.epoch_at(low) < k ? high : low;
    since += fmt::format("{}{:.0f}u", k == 0 ? "" : ", ", std::min(instant, 4294967295.0));
    variances.push_back(filter.gain_in(k, Sample(samples.data(), samples.size())).input_variance[0]);
  }
  return since + "};\n" + table("variance_of", variances);
}

CForm Maker::virtual_sensor() {
  const Settings& s = *choice_.settings;
  if (s["smoothed"] == 1) throw no_form(choice_, " as a smoother, which sees the whole run");
  if (s["input_deviation"] > 0) throw no_form(choice_, " with a model of the input");
  BiasFilter filter(*choice_.array, s["slowest_s"], static_cast<Eigen::Index>(s["most_states"]), InputModel{}, true);
  const Eigen::VectorXd whole = Eigen::VectorXd::Zero(choice_.array->channels);
  const BiasGain& gain = filter.gain_in(filter.epoch_at(1e300), Sample(whole.data(), whole.size()));
  const auto states = static_cast<std::size_t>(filter.states().size());
  std::vector<double> weights, gains, poles;
  std::string channel = fmt::format("static const unsigned char channel[{}] = {{", std::max<std::size_t>(states, 1));
  for (std::size_t i = 0; i < n_; ++i) weights.push_back(gain.weights(0, static_cast<Eigen::Index>(i)));
  for (std::size_t k = 0; k < states; ++k) {
    for (std::size_t i = 0; i < n_; ++i)
      gains.push_back(gain.gain(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(i)));
    poles.push_back(filter.states().pole[static_cast<Eigen::Index>(k)]);
    channel += fmt::format("{}{}", k == 0 ? "" : ", ", filter.states().channel[k]);
  }
  if (states == 0) {
    gains.assign(n_, 0);
    poles.assign(1, 1);
    channel += "0";
  }
  CForm out;
  out.state = fmt::format("  fusion_real drift[{}]; /* of the sensors */\n  uint32_t now, epoch;\n", poles.size());
  out.functions = epochs(filter, whole) + table("weight", weights) + table("gain", gains) + table("pole", poles) +
                  channel + "};\n" +
                  step(virtual_sensor_in_c(), {{"STATES", std::to_string(poles.size())},
                                               {"EPOCHS", std::to_string(filter.epoch_at(1e300) + 1)},
                                               {"NEARLY_ONE", number(1 - 1e-6)}});
  out.reals = poles.size();
  out.words = 2;
  const auto n = static_cast<double>(n_), m = static_cast<double>(poles.size());
  out.cost.sums = 4 * n + 2 * m * n + 3 * m;
  out.notes.emplace_back(
      "the gains are those of the steady state, also at the start; where a sensor has no sample, the weights of the "
      "others are scaled up");
  return out;
}

CForm Maker::perceptron() {
  const Settings& s = *choice_.settings;
  const auto most = (static_cast<std::size_t>(s["most_weights"]) - 1) / (n_ + 2);
  const std::size_t hidden = std::min(static_cast<std::size_t>(s["neurons"]), std::max<std::size_t>(most, 1));
  const std::vector<double>& p = learnt_list(choice_, "parameters", hidden * (n_ + 2) + 1);
  std::vector<double> inverse = learnt_list(choice_, "deviations", n_);
  CForm out;
  out.functions = table("mean", learnt_list(choice_, "means", n_)) + table("deviation", inverse) +
                  table("input_weight", p.data(), hidden * n_) + table("input_bias", p.data() + hidden * n_, hidden) +
                  table("output_weight", p.data() + hidden * (n_ + 1), hidden) +
                  step(perceptron_in_c(), {{"HIDDEN", std::to_string(hidden)},
                                           {"OUTPUT_BIAS", number(p.back())},
                                           {"TARGET_MEAN", number(learnt_number(choice_, "target_mean"))},
                                           {"TARGET_DEVIATION", number(learnt_number(choice_, "target_deviation"))},
                                           {"VARIANCE", number(learnt_number(choice_, "variance"))}});
  const auto n = static_cast<double>(n_), h = static_cast<double>(hidden);
  out.cost.sums = n + 2 * n * h + 3 * h + 2;
  out.cost.divisions = n;
  out.cost.tanhs = h;
  return out;
}

CForm Maker::tilt() {
  const Settings& s = *choice_.settings;
  if (!(choice_.array->rate_hz > 0)) throw no_form(choice_, " without a sampling rate");
  const double dt = 1 / choice_.array->rate_hz;
  double lambda = 1, start_s = 1;
  bool at_zero = false;
  if (choice_.algorithm == "tilt-complementary-tuned") {
    const double tau = learnt_number(choice_, "time_constant_s");
    lambda = tau / (tau + dt);
  } else {
    at_zero = s["start_at_zero"] == 1;
    start_s = s["start_s"];
    if (choice_.algorithm == "tilt-complementary")
      lambda = s["lambda"] >= 0 ? s["lambda"] : s["time_constant"] / (s["time_constant"] + dt);
  }
  CForm out;
  out.state = "  fusion_real angle, rate, heard, steps;\n  unsigned char known;\n";
  out.start = at_zero ? "  s->known = 1;\n" : "";
  out.functions = step(tilt_in_c(), {{"GYROSCOPE", std::to_string(choice_.array->tilt->gyroscope)},
                                     {"ACCELEROMETER_X", std::to_string(choice_.array->tilt->accelerometer_x)},
                                     {"ACCELEROMETER_Z", std::to_string(choice_.array->tilt->accelerometer_z)},
                                     {"START", number(at_zero ? 0 : std::floor(start_s / dt + 1e-6))},
                                     {"LAMBDA", number(lambda)},
                                     {"DT", number(dt)},
                                     {"PI", number(std::numbers::pi)}});
  out.reals = 4;
  out.bytes = 1;
  out.cost.sums = 16;
  out.cost.divisions = 3;
  out.cost.arctangents = 1;
  return out;
}

}  // namespace

std::string c_number(double value, bool single) {
  if (!std::isfinite(value)) value = value > 0 ? 1e30 : -1e30;
  std::string out = shortest(single ? static_cast<double>(static_cast<float>(value)) : value);
  if (out.find_first_of(".e") == std::string::npos) out += ".0";
  if (single) out += "f";
  return value < 0 ? "(" + out + ")" : out;
}

CForm c_form(const CChoice& choice) { return Maker(choice).make(); }

}  // namespace libchar::fusion
