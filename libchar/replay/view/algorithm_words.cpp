#include "libchar/replay/view/algorithm_words.hpp"

#include <fmt/format.h>

#include "libchar/core/text/decimal.hpp"

namespace libchar {

std::vector<std::string> needs_in_words(const fusion::Description& description) {
  const fusion::Needs& n = description.needs;
  std::vector<std::string> out;
  if (n.reference_throughout) out.emplace_back("the reference of the run itself");
  if (n.reference) out.emplace_back("a reference in a learning window");
  if (n.learning_samples > 0)
    out.push_back(fmt::format("at least {} learning instants", n.learning_samples));
  if (n.noise_levels) out.emplace_back("noise levels");
  if (n.noise_models) out.emplace_back("noise models");
  if (n.fault_free_start) out.emplace_back("a start without faults");
  if (n.tilt) out.emplace_back("one gyroscope axis and two accelerometer axes");
  if (n.rate) out.emplace_back("the sampling rate");
  if (n.min_channels > 1) out.push_back(fmt::format("at least {} sensors", n.min_channels));
  if (n.max_channels > 0) out.push_back(fmt::format("at most {} sensors", n.max_channels));
  if (n.more_than_inputs > 0)
    out.push_back(n.more_than_inputs == 1
                      ? std::string("more than one sensor an input")
                      : fmt::format("more than {} sensors an input", n.more_than_inputs));
  if (!n.observation_matrix && !n.tilt) out.emplace_back("one input, seen alike by all");
  if (!n.accepts_missing) out.emplace_back("no missing samples");
  return out;
}

std::string settings_in_words(const fusion::Settings& settings) {
  std::string out;
  for (std::size_t i = 0; i < settings.table().size(); ++i) {
    const fusion::Option& option = settings.table()[i];
    if (settings.values()[i] != option.standard)
      out += fmt::format("{}{} = {}{}{}",
                         out.empty() ? "" : ", ",
                         option.name,
                         shortest(settings.values()[i]),
                         option.unit.empty() ? "" : " ",
                         option.unit);
  }
  return out;
}

}  // namespace libchar
