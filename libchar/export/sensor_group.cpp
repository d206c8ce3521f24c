#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/export/exports.hpp"

namespace libchar {
namespace {

struct Kind {
  const char* name;
  char letter;  // of the places: gx, ax, mx
  Quantity quantity;
  const char* quantity_name;
  const char* si_unit;
  const char* example;
};
constexpr std::array<Kind, 3> kKinds = {{
    {"gyroscope", 'g', Quantity::angular_rate, "angular rate", "rad/s", "rad/s or deg/s"},
    {"accelerometer", 'a', Quantity::acceleration, "acceleration", "m/s^2", "m/s^2 or g"},
    {"magnetometer", 'm', Quantity::magnetic_field, "magnetic field", "T", "uT"},
}};
constexpr const char* kAxes = "xyz";

// Where a model goes: nothing when it is none of the three kinds; axis 3 stands for all three.
struct Place {
  std::size_t kind = 0;
  std::size_t axis = 3;
};

std::vector<std::string> place_names() {
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) {
    names.emplace_back(1, kind.letter);
    for (std::size_t i = 0; i < 3; ++i) names.push_back({kind.letter, kAxes[i]});
  }
  return names;
}

Place place_named(const std::string& name) {
  const std::vector<std::string> names = place_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw usage_error("E0581", "`axis`")
        .says("no such place; places are {}", fmt::join(names, ", "))
        .got(name)
        .hint("g, a and m alone stand for all three axes");
  const auto index = static_cast<std::size_t>(found - names.begin());
  return {index / 4, (index % 4 + 3) % 4};
}

std::size_t axis_index(const std::string& axis) {
  return axis.size() == 1 && axis[0] >= 'x' ? static_cast<std::size_t>(axis[0] - 'x') : 3;
}

void check_overrides(const std::vector<SensorModel>& models, const AxisOverrides& overrides) {
  std::vector<std::string> channels;
  channels.reserve(models.size());
  for (const SensorModel& model : models) channels.push_back(model.channel);
  for (const auto& [channel, place] : overrides) {
    place_named(place);
    if (std::find(channels.begin(), channels.end(), channel) != channels.end()) continue;
    const auto near = nearest(channel, channels);
    throw usage_error("E0582", "`axis`")
        .says("no model of this channel was given")
        .got(channel)
        .hint(did_you_mean(near, fmt::format("channels are {}", fmt::join(channels, ", "))));
  }
}

std::optional<Place> place_of(const SensorModel& model, const AxisOverrides& overrides) {
  for (const auto& [channel, place] : overrides)
    if (channel == model.channel) return place_named(place);
  const std::string kind = kind_of(model);
  for (std::size_t k = 0; k < kKinds.size(); ++k)
    if (kind == kKinds[k].name) return Place{k, axis_index(axis_of(model))};
  return std::nullopt;
}

double factor_to_si(const SensorModel& model, const Kind& kind) {
  const auto unit = find_unit(model.unit);
  if (unit && unit->quantity == kind.quantity) return unit->to_si;
  if (unit && unit->quantity == Quantity::angle && kind.quantity == Quantity::angular_rate)
    throw input_error("E0583", model.channel)
        .says("its unit is that of an angle, and a {} needs one of {}", kind.name, kind.quantity_name)
        .got(model.unit)
        .hint(
            "characterize the log as a rate: increments by `channel_scale` (the sampling rate) and `channel_unit`, an "
            "angle as phase");
  throw input_error("E0583", model.channel)
      .says(model.unit.empty()
                ? fmt::format("its model names no unit, a {} needs one of {}", kind.name, kind.quantity_name)
                : fmt::format("its unit is not one of {}, which a {} needs", kind.quantity_name, kind.name))
      .got(model.unit)
      .hint("write unit: {} into the model file", kind.example);
}

[[noreturn]] void refuse_duplicate(const Kind& kind, std::size_t axis, const SensorModel& first,
                                   const SensorModel& second) {
  const std::string place =
      axis < 3 ? fmt::format("the {} axis of the {}", kAxes[axis], kind.name) : fmt::format("the {}", kind.name);
  throw input_error("E0584", second.channel)
      .says("two models claim {}: {} and {}", place, printable(first.channel, 40), printable(second.channel, 40))
      .hint(first.channel == second.channel
                ? "leave one of the two files out"
                : fmt::format("leave one out, or say which it is: `axis` {}={}{}", printable(second.channel, 40),
                              kind.letter, axis < 3 ? kAxes[(axis + 1) % 3] : 'x'));
}

void put(std::optional<SensorTriad>& triad, const Kind& kind, std::size_t axis, PlacedModel placed) {
  if (!triad) triad = SensorTriad{kind.name, kind.si_unit, {}, false};
  for (std::size_t i = 0; i < 3; ++i) {
    if (axis < 3 && i != axis) continue;
    if (triad->axis[i]) refuse_duplicate(kind, axis, *triad->axis[i]->model, *placed.model);
    triad->axis[i] = placed;
  }
  triad->shared = axis == 3;
}

}  // namespace

SensorGroup group_sensors(const std::vector<SensorModel>& models, const AxisOverrides& overrides) {
  check_overrides(models, overrides);
  SensorGroup group;
  std::array<std::vector<std::pair<std::size_t, const SensorModel*>>, 3> members;
  for (const SensorModel& model : models) {
    group.all.push_back(&model);
    if (const auto place = place_of(model, overrides))
      members[place->kind].emplace_back(place->axis, &model);
    else
      group.others.push_back(&model);
  }
  std::optional<SensorTriad>* triads[] = {&group.gyroscope, &group.accelerometer, &group.magnetometer};
  for (std::size_t k = 0; k < kKinds.size(); ++k) {
    for (const auto& [axis, model] : members[k]) {
      if (axis == 3 && members[k].size() > 1)
        throw input_error("E0585", model->channel)
            .says("is one of {} {} models and names no axis", members[k].size(), kKinds[k].name)
            .hint("say which axis it is: `axis` {}={}x", printable(model->channel, 40), kKinds[k].letter);
      put(*triads[k], kKinds[k], axis, {model, factor_to_si(*model, kKinds[k])});
    }
  }
  return group;
}

void require_axes(const SensorTriad& triad, std::optional<std::size_t> only) {
  std::string missing;
  std::vector<std::size_t> present;
  for (std::size_t i = 0; i < 3; ++i) {
    if (triad.axis[i])
      present.push_back(i);
    else if (!only || *only == i)
      missing += fmt::format("{}{}", missing.empty() ? "" : " and ", kAxes[i]);
  }
  if (missing.empty()) return;
  std::string hint = fmt::format("give its file, or take one axis alone: `axes` {}", kAxes[present[0]]);
  if (present.size() == 1)
    hint += fmt::format(", or let it stand for all three: `axis` {}={}",
                        printable(triad.axis[present[0]]->model->channel, 40), triad.kind[0]);
  throw input_error("E0586").says("the {} has no model for {}", triad.kind, missing).hint(hint);
}

}  // namespace libchar
