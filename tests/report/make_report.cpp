// make_report KIND FOLDER: writes a report of a synthetic characterization for the browser test (browser_test.py).
#include <cstdio>
#include <exception>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/file/whole_file.hpp"
#include "libchar/model/model_file.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/text/curves_text.hpp"
#include "tests/report/synthetic.hpp"

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string kind = argv[1], folder = argv[2];
  try {
    const auto result = kind == "hostile" ? test::hostile()
                        : kind == "many"  ? test::many_channels(48)
                        : kind == "empty" ? test::barely_anything()
                        : kind == "tiny"  ? test::at_the_ends_of_doubles()
                                          : test::synthetic_imu();
    std::filesystem::create_directories(folder);
    libchar::write_whole_file(folder + "/report.html", libchar::html_report(result), true);
    libchar::write_whole_file(folder + "/report.json", libchar::dump_json(libchar::json_report(result)), true);
    libchar::write_whole_file(folder + "/curves.csv", libchar::csv_curves(result), true);
    if (const auto& c = result.channels[0]; c.fit) {
      libchar::write_whole_file(folder + "/model.sensor.yaml",
                                libchar::model_yaml(libchar::sensor_model_from(c, result.log)), true);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "make_report: %s\n", error.what());
    return 1;
  }
}
