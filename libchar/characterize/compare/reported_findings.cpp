#include "libchar/characterize/compare/reported_findings.hpp"

#include "libchar/core/document/coefficient_fields.hpp"

namespace libchar::detail {

std::vector<Finding> reported_findings(const MapReader& document) {
  std::vector<Finding> out;
  if (document.has("findings"))
    for (const MapReader& row : document.maps("findings")) {
      Finding one;
      read_fields(finding_fields(), row, one);
      one.subject = kOfRecording;
      if (one.severity != Severity::note && !one.effects.empty()) out.push_back(std::move(one));
    }
  const MapReader rows = document.has("summary") ? document.map("summary") : document;
  if (!rows.has("channels")) return out;
  for (const MapReader& channel : rows.maps("channels")) {
    if (!channel.has("name") || !channel.has("findings")) continue;
    for (const MapReader& row : channel.maps("findings")) {
      Finding one;
      read_fields(finding_fields(), row, one);
      one.subject = channel.text("name");
      if (one.severity != Severity::note) out.push_back(std::move(one));
    }
  }
  return worst_first(std::move(out));
}

}  // namespace libchar::detail
