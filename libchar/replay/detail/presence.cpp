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
    if (run == 0 || values[k] != value) {
      run = 0;
      run_from = at + k;
    }
    value = values[k];
    const bool longest = run_from == still_from;
    if (++run <= still) {
      if (!longest) next_still = std::max(next_still, run);
      continue;
    }
    if (!longest) next_still = still;
    still = run;
    still_from = run_from;
  }
}

bool is_frozen(std::span<const Presence> presence, std::size_t i, std::uint64_t samples) {
  constexpr double kShortest = 100, kShareOfRun = 0.01, kLonger = 8;
  if (presence.size() < 3) return false;
  std::vector<double> others;
  for (std::size_t k = 0; k < presence.size(); ++k)
    if (k != i) others.push_back(static_cast<double>(presence[k].still));
  const double usual = std::max(median_in_place(others, Middle::upper), static_cast<double>(presence[i].next_still));
  return static_cast<double>(presence[i].still) >
         std::max({kShortest, kShareOfRun * static_cast<double>(samples), kLonger * usual});
}

std::string still_words(const std::string& name, const Presence& at, double rate_hz) {
  return fmt::format("{} from {} to {} s", name, place_text(static_cast<double>(at.still_from) / rate_hz),
                     place_text(static_cast<double>(at.still_from + at.still) / rate_hz));
}

}  // namespace libchar
