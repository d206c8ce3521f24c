#include "libchar/scene/text/typed_text.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/document/document.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/scene/detail/scene_values.hpp"

namespace libchar {

namespace {

/// A scene has defaults for how large a signal is; on a command line a forgotten size would go unseen.
void refuse_without_size(const std::string& text, const std::string& place) {
  static constexpr std::pair<std::string_view, std::string_view> kSizes[] = {{"sine", "amplitude"},
                                                                             {"chirp", "amplitude"},
                                                                             {"uniform", "amplitude"},
                                                                             {"noise", "standard_deviation"},
                                                                             {"random_walk", "step"}};
  for (const auto& [kind, size] : kSizes)
    if (text.substr(0, text.find(',')) == kind && text.find(fmt::format(",{}=", size)) == std::string::npos)
      throw usage_error("E0721", place)
          .says("how large? {} needs its {}", kind, size)
          .got(text)
          .hint("such as {},{}=2", kind, size);
}

}  // namespace

SignalSpec parse_signal(const std::string& text, const std::string& place) {
  if (const auto value = parse_double(text)) {
    SignalSpec constant;
    constant.kind = "constant";
    constant.value = *value;
    return constant;
  }
  // The map that a scene file would hold.
  std::string map = "{kind: " + text.substr(0, text.find(','));
  for (std::size_t at = text.find(','); at != std::string::npos;) {
    const std::size_t end = text.find(',', at + 1);
    const std::string pair = text.substr(at + 1, end == std::string::npos ? end : end - at - 1);
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos)
      throw usage_error("E0721", place)
          .says("expected KIND,key=value,…")
          .got(text)
          .hint("such as sine,amplitude=2,frequency_hz=0.1");
    map += ", " + pair.substr(0, equals) + ": " + pair.substr(equals + 1);
    at = end;
  }
  SignalSpec signal = read_signal(parse_yaml_document(map + "}", place), place, "");
  refuse_without_size(text, place);
  return signal;
}

namespace {

void set_times(const std::string& when, const std::string& form, SensorFault& fault) {
  try {
    const Interval range = parse_range(when);
    fault.from_s = range.low;
    fault.to_s = range.high;
  } catch (const Error& error) {
    throw usage_error("E0722", "`fault`").says(error.problem().what).got(error.problem().got).hint(form);
  }
}

}  // namespace

SensorFault parse_fault(const std::string& text, const std::vector<std::string>& names) {
  const std::string form = "SENSOR:KIND[=VALUE]@FROM..TO";
  const std::size_t at = text.rfind('@'), colon = at == std::string::npos ? at : text.rfind(':', at);
  if (colon == std::string::npos)
    throw usage_error("E0722", "`fault`")
        .says("expected " + form + " in seconds")
        .got(text)
        .hint("such as gyr_x:bias=0.2@100..200");
  const std::string name = text.substr(0, colon), what = text.substr(colon + 1, at - colon - 1),
                    when = text.substr(at + 1);
  SensorFault fault;
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    const auto near = nearest(name, names);
    throw usage_error("E0722", "`fault`")
        .says("there is no such sensor")
        .got(name)
        .hint(did_you_mean(near, fmt::format("the sensors are {}", fmt::join(names, ", "))));
  }
  fault.sensor = static_cast<std::size_t>(found - names.begin());
  const std::size_t equals = what.find('=');
  const std::string kind = what.substr(0, equals);
  const auto known = find_enum<FaultKind>(kind);
  if (!known)
    throw usage_error("E0722", "`fault`").says("expected one of {}", fmt::join(words_of<FaultKind>(), ", ")).got(kind);
  fault.kind = *known;
  const auto number = [&](const std::string& word) {
    const auto value = parse_double(word);
    if (!value) throw usage_error("E0722", "`fault`").says("expected a number in " + form).got(word);
    if (std::abs(*value) > kLargestSample)
      throw usage_error("E0722", "`fault`").says("a sample cannot be beyond " + shortest(kLargestSample)).got(word);
    return *value;
  };
  const bool valueless = fault.kind == FaultKind::stuck || fault.kind == FaultKind::dropout;
  if (valueless != (equals == std::string::npos))
    throw usage_error("E0722", "`fault`")
        .says(valueless ? kind + " takes no value" : kind + " needs a value")
        .got(text)
        .hint(form);
  if (!valueless) fault.value = number(what.substr(equals + 1));
  if ((fault.kind == FaultKind::saturation || fault.kind == FaultKind::noise) && fault.value < 0)
    throw usage_error("E0722", "`fault`").says(kind + " needs a value of at least 0").got(what.substr(equals + 1));
  set_times(when, form, fault);
  return fault;
}

}  // namespace libchar
