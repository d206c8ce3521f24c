#include "libchar/report/text/allan_text.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "libchar/characterize/curves/curve_document.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/text/csv_cell.hpp"

namespace libchar {

std::string allan_csv(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves) {
  std::string text = "channel,unit,tau_s,deviation,low68,high68,low95,high95,edf,terms,curve\n";
  for (std::size_t c = 0; c < std::min(channels.size(), curves.size()); ++c)
    for (const AllanPoint& p : curves[c].points) {
      const bool stated = !deviation_row(curves[c].type).without_interval();
      const auto known = [&](double value) { return stated ? value : kNone; };
      text += csv_line(channels[c].name,
                       deviation_unit(curves[c].type, channels[c].unit),
                       p.tau_s,
                       p.deviation,
                       known(p.ci68.low),
                       known(p.ci68.high),
                       known(p.ci95.low),
                       known(p.ci95.high),
                       known(p.edf),
                       p.terms,
                       name_of(curves[c].type));
    }
  return text;
}

namespace {

/// In the order in which they come.
std::vector<DeviationType> types_of(const std::vector<AllanCurve>& curves) {
  std::vector<DeviationType> types;
  for (const AllanCurve& curve : curves)
    if (std::find(types.begin(), types.end(), curve.type) == types.end())
      types.push_back(curve.type);
  return types;
}

}  // namespace

Json allan_json(const std::vector<Channel>& channels, const std::vector<AllanCurve>& curves) {
  const std::vector<DeviationType> types = types_of(curves);
  AllanDocument out;
  out.type = name_of(types.empty() ? DeviationType::oadev : types[0]);
  if (types.size() > 1)
    for (const DeviationType type : types) out.types.emplace_back(name_of(type));
  for (std::size_t i = 0; i < std::min(channels.size(), curves.size()); ++i) {
    out.channels.push_back(allan_of_channel(channels[i], curves[i]));
    if (types.size() > 1) out.channels.back().type = name_of(curves[i].type);
  }
  return document_of(allan_fields(), out);
}

}  // namespace libchar
