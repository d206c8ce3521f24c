#include "libchar/report/report_files.hpp"

#include <nlohmann/json.hpp>
#include <set>

#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/file/file_name.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/json/json_report.hpp"
#include "libchar/report/text/curves_text.hpp"

namespace libchar {

std::vector<OutputFile> report_files(const CharacterizationView& view,
                                     const std::filesystem::path& folder) {
  const Characterization& result = *view.result;
  Json document = json_without_times(view);
  std::vector<OutputFile> outputs = {
      {(folder / "report.html").string(), html_report(view, document)}};
  add_times(document, result);
  outputs.push_back({(folder / "report.json").string(), ""});
  outputs.push_back({(folder / "curves.csv").string(), csv_curves(view)});
  std::set<std::string> taken;
  for (const ChannelResult& c : result.channels) {
    if (!c.fit) continue;
    const std::string name = unused_file_name_for(c.channel.name, taken);
    outputs.push_back({(folder / (name + ".sensor.yaml")).string(),
                       model_yaml(sensor_model_from(c, result.log))});
  }
  name_files(document, outputs);
  outputs[1].text = dump_json(document);
  return outputs;
}

}  // namespace libchar
