#include "libchar/export/exports.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/export/detail/consumer_rows.hpp"

namespace libchar {
namespace {

using enum ExportNeeds;

std::string channels_of(const SensorGroup& group) {
  std::string text;
  for (const SensorModel* m : group.all)
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", printable(m->channel, 40), kind_of(*m));
  return text;
}

void check_needs(const ExportTarget& target, const SensorGroup& group) {
  const bool gyroscope = group.gyroscope.has_value();
  const bool accelerometer = group.accelerometer.has_value();
  const bool met = target.needs == any_sensor                   ? !group.all.empty()
                   : target.needs == gyroscope_or_accelerometer ? gyroscope || accelerometer
                                                                : gyroscope && accelerometer;
  if (met) return;
  const bool both = target.needs == gyroscope_and_accelerometer;
  throw input_error("E0590")
      .says("{} needs models of a gyroscope {} an accelerometer, and there is no {} among {}", target.title,
            both ? "and" : "or", both ? (gyroscope ? "accelerometer" : "gyroscope") : "one of them",
            group.all.empty() ? "no models" : channels_of(group))
      .hint("give all files of the device; where name and unit do not say what a channel is: `axis` NAME=gx");
}

void check_options(const ExportOptions& options) {
  const auto positive = [](const char* name, double value) {
    if (!(value > 0)) throw usage_error("E0591", name).says("expected a number > 0").got(shortest(value));
  };
  positive("`inflate`", options.inflate);
  positive("`filter_step_s`", options.filter_step_s);
  if (options.correlation_s) positive("`correlation_s`", *options.correlation_s);
  if (options.floor_tau_s) positive("`floor_tau_s`", *options.floor_tau_s);
  if (options.bias_tau_s) positive("`bias_tau_s`", *options.bias_tau_s);
  if (options.gravity) positive("`gravity`", *options.gravity);
}

void note_left_out(const ExportTarget& target, const SensorGroup& group, Export& out) {
  if (target.needs == any_sensor) return;
  const auto leave = [&](const SensorModel& m) {
    out.notes.push_back(fmt::format("{}: a {} has no place in a file for {}; left out", printable(m.channel, 40),
                                    kind_of(m), target.title));
  };
  for (const SensorModel* m : group.others) leave(*m);
  if (!group.magnetometer || target.takes.magnetometer) return;
  for (const auto& placed : group.magnetometer->axis)
    if (placed) leave(*placed->model);
}

// A shape that adds power: a resonance, a second process.
std::string added_text(const SensorGroup& group) {
  constexpr double kAdds = 1.5;
  double most = kAdds, at_hz = 0;
  const SensorModel* of = nullptr;
  for (const SensorModel* m : group.all)
    for (std::size_t i = 0; i < m->noise_shape.ratio.size(); ++i) {
      if (!(m->noise_shape.ratio[i] > most)) continue;
      most = m->noise_shape.ratio[i];
      at_hz = m->noise_shape.frequency_hz[i];
      of = m;
    }
  if (of == nullptr) return "";
  return fmt::format(", and the power of {} is up to {} times what they give (at {} Hz)", printable(of->channel, 40),
                     brief_text(most, 2), brief_text(at_hz, 2));
}

// What is known of the sensors and gets lost: terms that the consumer has no word for, and the
// low-pass, behind which samples scatter less than N sqrt(f) and neighbours are correlated.
std::vector<std::string> unexpressed(const ExportTarget& target, const SensorGroup& group) {
  std::vector<std::string> out;
  const auto among = [&](const auto& concerned) {
    std::string channels;
    for (const SensorModel* m : group.all)
      if (concerned(*m)) channels += (channels.empty() ? "" : ", ") + printable(m->channel, 40);
    return channels;
  };
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (target.terms.find(kTermNames[t].letter) != std::string_view::npos) continue;
    const std::string channels = among([&](const SensorModel& m) { return m.noise[t].value.value_or(0) > 0; });
    if (!channels.empty()) out.push_back(fmt::format("not in this file: {} of {}", kTermNames[t].key, channels));
  }
  const std::string process = among([](const SensorModel& m) { return m.gauss_markov.sigma > 0; });
  if (!process.empty() && !target.takes.gauss_markov && !target.takes.status)
    out.push_back(fmt::format("not in this file: the correlation time of the Gauss-Markov process of {}{}", process,
                              target.terms.find('K') == std::string_view::npos
                                  ? ""
                                  : "; as a random walk of its driving density it holds for times well below that"));
  const std::string filtered =
      among([](const SensorModel& m) { return m.bandwidth_hz && *m.bandwidth_hz <= m.rate_hz / 2; });
  if (!filtered.empty() && !target.takes.low_pass)
    out.push_back(
        fmt::format("not in this file: the low-pass of {}; densities are kept, single samples scatter less", filtered));
  const std::string shaped = among([](const SensorModel& m) { return m.noise_shape.kind != NoiseShape::Kind::none; });
  if (!shaped.empty() && !target.takes.status)
    out.push_back(fmt::format(
        "not in this file: the shape of the noise of {} over frequency; densities are those of slow frequencies{}",
        shaped, added_text(group)));
  return out;
}

// Those of the file, and what the statuses say where nobody wrote findings.
std::vector<Finding> findings_of(const SensorModel& m) {
  std::vector<Finding> out = m.findings;
  std::string terms;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (m.noise[t].status == Status::misfit) terms += fmt::format("{}{}", terms.empty() ? "" : ", ", kTermNames[t].key);
  if (!terms.empty() && worst_of(out) != Severity::bad)
    out.push_back(finding("misfit", terms + ": misfit, the noise terms do not describe the recording"));
  return out;
}

// "use the longest still stretch (`still` auto), or ": its own remedy, else that of its kind; "" where there is none.
std::string remedy_of(const Finding& one) {
  std::string remedy;
  const FindingKind* kind = find_finding_kind(one.code);
  if (!one.help.empty())
    remedy = as_part(one.help[0].sentence) + settings_text(one.help[0]);
  else if (kind != nullptr)
    remedy = as_part(std::string(kind->remedy));
  return remedy.empty() ? "" : remedy + ", or ";
}

// A consumer takes what the file says for known: numbers that are not to be relied on are refused, what asks for a look
// goes with a sentence.
void answer_findings(const ExportTarget& target, const SensorGroup& group, const ExportOptions& options,
                     std::vector<std::string>& notes) {
  if (target.takes.status) return;
  for (const SensorModel* m : group.all)
    for (const Finding& one : findings_of(*m)) {
      if (one.severity == Severity::note) continue;
      const std::string what = fmt::format("{}: {}", printable(m->channel, 40), printable(one.sentence));
      if (one.severity == Severity::bad && !options.anyway)
        throw input_error("E0594")
            .says(what.ends_with('.') ? what.substr(0, what.size() - 1) : what)
            .hint(remedy_of(one) + "export it with `anyway`");
      notes.push_back(what);
    }
}

void drop_repeated(std::vector<std::string>& notes) {
  std::vector<std::string> once;
  for (std::string& note : notes)
    if (std::find(once.begin(), once.end(), note) == once.end()) once.push_back(std::move(note));
  notes = std::move(once);
}

}  // namespace

std::string needs_text(ExportNeeds needs) {
  if (needs == any_sensor) return "any sensor";
  return needs == gyroscope_and_accelerometer ? "gyroscope and accelerometer" : "gyroscope or accelerometer";
}

std::string targets_that_take(bool ExportTakes::*option) {
  std::string names;
  for (const ExportTarget& target : export_targets())
    if (target.takes.*option) names += fmt::format("{}{}", names.empty() ? "" : ", ", target.name);
  return names;
}

namespace {

/// Programs that take the numbers of a target under other keys.
struct Alike {
  std::string_view program, target, keys;
};
constexpr Alike kAlike[] = {
    {"lvi-sam", "gtsam", "acc_n, gyr_n, acc_w, gyr_w of its LIO part are the roots of its covariances"},
    {"msckf", "kalibr", "noise/acc, noise/gyro, noise/acc_bias, noise/gyro_bias are its four densities"},
    {"gazebo", "sdf", "its sensors are written in SDFormat"},
    {"vins-mono", "vins", "its file has the same keys"},
    {"vins-fusion", "vins", "its file has the same keys"},
    {"okvis2", "okvis", "its file has the same keys"},
    {"fast-lio2", "fast-lio", "its file has the same keys"},
    {"robot_localization", "ros", "it reads the covariances of the messages"},
    {"isaac", "pegasus", "the same densities and correlation time"},
    {"ekf2", "px4", "its parameters"},
    {"ardupilot", "px4", "it has the parameters of EK3 next to those of EKF2"},
};

std::string alike_hint(std::string_view name) {
  // "robot-localization" as well as "robot_localization"
  const auto same = [](char a, char b) { return a == b || (a == '-' && b == '_') || (a == '_' && b == '-'); };
  for (const Alike& one : kAlike)
    if (std::equal(one.program.begin(), one.program.end(), name.begin(), name.end(), same))
      return fmt::format("{} takes what {} takes: {}", one.program, one.target, one.keys);
  return "";
}

}  // namespace

const ExportTarget& find_export_target(std::string_view name) {
  for (const ExportTarget& target : export_targets())
    if (target.name == name) return target;
  std::vector<std::string> names;
  for (const ExportTarget& target : export_targets()) names.emplace_back(target.name);
  const auto near = nearest(name, names);
  const std::string hint = alike_hint(name);
  throw usage_error("E0592", "`target`")
      .says("no such target; targets are {}", fmt::join(names, ", "))
      .got(std::string(name))
      .hint(hint.empty() ? did_you_mean(near, "`export_targets` lists them") : hint);
}

Export export_models(const ExportTarget& target, const std::vector<SensorModel>& models, const ExportOptions& options) {
  check_options(options);
  SensorGroup group = group_sensors(models, options.axis);
  check_needs(target, group);
  group.unexpressed = unexpressed(target, group);
  answer_findings(target, group, options, group.unexpressed);
  Export out = target.write(group, options);
  out.notes.insert(out.notes.begin(), group.unexpressed.begin(), group.unexpressed.end());
  if (options.inflate != 1 && target.takes.inflate)
    out.notes.push_back(fmt::format("every noise number is multiplied by {}", shortest(options.inflate)));
  note_left_out(target, group, out);
  drop_repeated(out.notes);
  return out;
}

namespace {

// A coefficient raised to a power and converted; a limit stays a limit.
std::string converted(const Coefficient& c, double factor, int power) {
  if (power == 1) return value_text(c, factor);
  if (c.value) return number_text(*c.value * *c.value * factor, 4);
  if (c.upper95) return "≤ " + number_text(*c.upper95 * *c.upper95 * factor, 3);
  return "–";
}

std::string_view sensor_in(const std::optional<Unit>& unit) {
  if (unit && unit->quantity == Quantity::angular_rate) return "gyroscope";
  if (unit && unit->quantity == Quantity::acceleration) return "accelerometer";
  return "other";
}

// "U/√Hz" in the channel's own unit, which may be unknown.
std::string unit_of(const ConsumerRow& row, const std::string& own) {
  const bool in_own = row.unit.starts_with('U') && !own.empty();
  return in_own ? own + std::string(row.unit.substr(1)) : std::string(row.unit);
}

}  // namespace

std::vector<ConsumerNumber> consumer_numbers(const Coefficients& coefficients, const std::string& unit,
                                             double rate_hz) {
  const auto known = find_unit(unit);
  const std::string_view sensor = sensor_in(known);
  const RowTimes times{.rate_hz = rate_hz};
  std::vector<ConsumerNumber> out;
  for (const ConsumerRow& row : consumer_table()) {
    const bool any = row.sensor.empty();
    const Coefficient& c = coefficients[static_cast<std::size_t>(row.term)];
    if (!row.in_report || (!any && row.sensor != sensor) || (!c.value && !c.upper95)) continue;
    const double si = any || sensor == "other" ? 1 : known->to_si;
    const double factor = (row.power == 2 ? si * si : si) * row.factor(times);
    out.push_back({std::string(row.consumer), std::string(row.key), std::string(row.formula),
                   converted(c, factor, row.power), unit_of(row, unit)});
  }
  return out;
}

}  // namespace libchar
