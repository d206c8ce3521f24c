#include "libchar/report/detail/verification_json.hpp"

#include <nlohmann/json.hpp>

#include "libchar/characterize/verification.hpp"
#include "libchar/report/detail/escape.hpp"
#include "libchar/report/detail/json_pieces.hpp"

namespace libchar {

Json verification_json(const ChannelView& view) {
  const ChannelResult& channel = *view.result;
  const ChannelVerification& v = *channel.verification;
  Json out = {
      {"name", json_text(channel.channel.name)}, {"agrees", v.agrees}, {"nearly", v.nearly}};
  out["sentences"] = Json::array();
  for (const std::string& sentence : v.sentences) out["sentences"].push_back(json_text(sentence));
  out["terms"] = Json::array();
  for (const TermVerification& t : v.terms) {
    const auto value = [](const Coefficient& c) {
      return c.value ? Json(*c.value) : Json(nullptr);
    };
    out["terms"].push_back({{"term", kTermNames[static_cast<std::size_t>(t.term)].key},
                            {"model", value(t.model)},
                            {"simulated", value(t.simulated)},
                            {"agrees", t.agrees}});
    if (t.simulated.value)
      out["terms"].back()["simulated_ci95"] = {t.simulated.ci95.low, t.simulated.ci95.high};
  }
  out["points"] = Json::array();
  for (const PointVerification& point : v.points)
    out["points"].push_back(
        {{"tau_s", point.tau_s}, {"ratio", point.ratio}, {"p", point.p}, {"agrees", point.agrees}});
  out["allan"] = allan_channel_json(channel.channel, v.allan, nullptr);
  out["spectrum"] =
      spectrum_channel_json(channel.channel, v.spectrum, nullptr, view.verification_ci95);
  return out;
}

}  // namespace libchar
