// The IMU part of a Basalt calibration. The keys say "std" and mean continuous densities: the code multiplies the noise
// by sqrt(imu_update_rate) and divides the bias by it. Read by cereal, which finds named values by name but takes the
// first value of the document for value0: nothing may stand in front of it.

#include <nlohmann/json.hpp>

#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"
#include "libchar/export/detail/export_text.hpp"
#include "libchar/export/detail/target_list.hpp"

namespace libchar {
namespace {

struct BasaltWriter {
  const ExportOptions& options;
  Export& out;
  Json& comments;

  // A vector, one number for each axis; one number in old files.
  Json numbers(const ConsumerRow& row, const SensorTriad& triad) {
    const std::string key(row.key);
    const ExportFigure largest = positive_figure(triad, row.term, options, "Basalt", key);
    if (options.older) {
      comment(key, largest.origin);
      return number(row, largest);
    }
    Json list = Json::array();
    std::array<std::string, 3> origins;
    const auto figures = axis_figures(triad, row.term, Absent::limit, options);
    for (std::size_t i = 0; i < 3; ++i) {
      // An axis of which nothing is known gets what the others have at most.
      list.push_back(number(row, figures[i].value ? figures[i] : largest));
      origins[i] = figures[i].origin + (figures[i].value ? "" : ": the largest of the others");
    }
    comment(key, axis_origins(origins));
    return list;
  }

  void comment(const std::string& key, const std::string& origin) {
    if (!origin.empty()) comments[key] = origin;
  }

  double number(const ConsumerRow& row, const ExportFigure& figure) {
    if (figure.limit) note_figure(out.notes, row.key, figure);
    return row_value(row, *figure.value);
  }
};

Export write_basalt(const SensorGroup& group, const ExportOptions& options) {
  Export out;
  Json comments = Json::object();
  BasaltWriter writer{options, out, comments};
  Json value = Json::object();
  value["imu_update_rate"] = rate_of(*group.gyroscope, out.notes);
  for (const Term term : {Term::white, Term::walk})
    for (const SensorTriad* triad : {&*group.accelerometer, &*group.gyroscope}) {
      const ConsumerRow& row = row_of("basalt", triad->kind, term);
      value[std::string(row.key)] = writer.numbers(row, *triad);
    }
  Json head = head_json(group, options,
                        "noise_std = white_noise, bias_std = random_walk (roots of two-sided, continuous densities, SI "
                        "units; the code makes them discrete itself)");
  if (!comments.empty()) head["comments"] = comments;
  Json document = Json::object();
  document["value0"] = value;
  document["sensorchar"] = head;
  out.text = dump_json(document);
  out.notes.emplace_back("merge the five keys into value0 of your calibration; the key sensorchar is ignored there");
  if (!options.older) out.notes.emplace_back("releases whose calibrations hold one number in place of three: `older`");
  return out;
}

}  // namespace

ExportTarget basalt_target() {
  return {"basalt",
          "Basalt",
          "continuous densities, though named std: N and K, one for each axis",
          "calibration_imu.json",
          ExportNeeds::gyroscope_and_accelerometer,
          "NK",
          {.older = true},
          write_basalt};
}

}  // namespace libchar
