#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/replay/detail/scene_source.hpp"

namespace libchar {

void Presence::push(std::uint64_t at, std::span<const double> values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (!std::isfinite(values[k])) continue;
    if (samples++ == 0) first = at + k;
    last = at + k;
    run = run > 0 && values[k] == value ? run + 1 : 1;
    value = values[k];
    if (run <= still) continue;
    still = run;
    still_from = at + k + 1 - run;
  }
}

bool is_frozen(std::span<const Presence> presence, std::size_t i, double from, double to) {
  constexpr double kShortest = 100, kShareOfRun = 0.01, kLongerThanOthers = 20;
  if (presence.size() < 3) return false;
  std::vector<double> others;
  for (std::size_t k = 0; k < presence.size(); ++k)
    if (k != i) others.push_back(static_cast<double>(presence[k].still));
  const double usual = median_in_place(others, Middle::upper);
  const auto begins = static_cast<double>(presence[i].still_from);
  const double inside =
      std::min(to, begins + static_cast<double>(presence[i].still)) - std::max(from, begins);
  return inside > std::max({kShortest, kShareOfRun * (to - from), kLongerThanOthers * usual});
}

std::string still_words(const std::string& name, const Presence& at, double rate_hz) {
  return fmt::format("{} from {} to {} s",
                     name,
                     place_text(static_cast<double>(at.still_from) / rate_hz),
                     place_text(static_cast<double>(at.still_from + at.still) / rate_hz));
}

}  // namespace libchar
