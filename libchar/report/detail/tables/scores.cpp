#include "libchar/report/detail/tables/scores.hpp"

#include <cmath>

#include "libchar/core/text/readable.hpp"
#include "libchar/report/detail/replay_words.hpp"

namespace libchar {

Table::Column score_column(bool has_reference, const std::string& unit) {
  const std::string name = has_reference ? "RMSE" : "leave-one-out RMS";
  const std::string usual = usual_unit(unit);
  return {usual.empty() ? name : name + ", " + usual, "rmse,low95,high95"};
}

Cell regret_cell(double regret) {
  return Cell::shown(excess_text(regret), regret);
}

Cell time_cell(double nanoseconds) {
  return Cell::shown(duration_text(1e-9 * nanoseconds), nanoseconds);
}

Cell memory_cell(double bytes) {
  const auto whole =
      std::isfinite(bytes) ? std::optional(static_cast<std::uint64_t>(bytes)) : std::nullopt;
  return Cell::shown(bytes_text(whole), bytes);
}

}  // namespace libchar
