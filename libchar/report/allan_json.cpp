#include "libchar/report/allan_json.hpp"

#include <nlohmann/json.hpp>

#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {

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
