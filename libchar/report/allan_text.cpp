#include "libchar/report/allan_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/core/csv_cell.hpp"
#include "libchar/core/decimal.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {

std::string allan_csv(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves) {
  std::string text = "channel,unit,tau_s,deviation,low68,high68,low95,high95,edf,terms,curve\n";
  for (std::size_t c = 0; c < std::min(channels.size(), curves.size()); ++c)
    for (const AllanPoint& p : curves[c].points)
      text += fmt::format("{},{},{},{},{},{},{},{},{},{},{}\n",
                          csv_cell(channels[c].name),
                          csv_cell(channels[c].unit),
                          shortest(p.tau_s),
                          shortest(p.deviation),
                          shortest(p.ci68.low),
                          shortest(p.ci68.high),
                          shortest(p.ci95.low),
                          shortest(p.ci95.high),
                          shortest(p.edf),
                          p.terms,
                          name_of(curves[c].type));
  return text;
}

Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves) {
  Json out = json_frame("allan");
  out["type"] = name_of(curves.empty() ? DeviationType::oadev : curves[0].type);
  out["channels"] = Json::array();
  for (std::size_t i = 0; i < std::min(channels.size(), curves.size()); ++i) {
    out["channels"].push_back(allan_channel_json(channels[i], curves[i], nullptr));
  }
  return out;
}

}  // namespace libchar
