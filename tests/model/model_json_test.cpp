
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/fields.hpp"
#include "libchar/core/error.hpp"
#include "libchar/model/model_fields.hpp"
#include "libchar/model/model_file.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

SensorModel small_model(const std::string& channel) {
  return parse_sensor_model(
      "format: sensor-model\nversion: 1\nunit: rad/s\nrate_hz: 200\ndensity: two-sided\nchannel: " + channel +
          "\nwhite_noise: 1e-4\n",
      "m.yaml");
}

std::vector<SensorModel> read_back(const std::string& text) {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "models.json").string();
  std::ofstream(path) << text;
  return read_model_list(path);
}

std::string refused(const std::string& text) {
  try {
    read_back(text);
  } catch (const Error& error) {
    const std::string said = error.what();
    return said.substr(said.find("models.json"));
  }
  return "";
}

}  // namespace

TEST_CASE("models: one is written as itself, several as a list, and both read back") {
  const SensorModel x = small_model("gyr_x"), y = small_model("gyr_y");
  const Json one = models_json({&x}), two = models_json({&x, &y});
  CHECK(one == model_json(x));
  CHECK(one["format"] == "sensor-model");
  CHECK(two["format"] == "sensor-models");
  REQUIRE(two["models"].size() == 2);
  CHECK(two["models"][1] == model_json(y));
  const auto of_one = read_back(one.dump()), of_two = read_back(two.dump());
  REQUIRE(of_one.size() == 1);
  CHECK(model_json(of_one[0]) == one);
  REQUIRE(of_two.size() == 2);
  CHECK(model_json(of_two[0]) == model_json(x));
  CHECK(model_json(of_two[1]) == model_json(y));
  CHECK(models_json({})["models"].empty());
}

TEST_CASE("models: a list that is none or empty, and text that is no model, are refused") {
  const std::string front = R"({"format": "sensor-models", "version": 1, "models": )";
  CHECK_THAT(refused(front + "[]}"), Catch::Contains("models: an empty list"));
  CHECK_THAT(refused(front + "3}"), Catch::Contains("error E0541: models: expected a list"));
  CHECK_THAT(refused("3"), Catch::StartsWith("models.json:1:1: error"));
}

TEST_CASE("models: the keys of a term stand once in the table of keys") {
  const std::string table = markdown_table(model_fields());
  const std::size_t first = table.find("– `upper95`");
  REQUIRE(first != std::string::npos);
  CHECK(table.find("– `upper95`", first + 1) == std::string::npos);
  CHECK(table.find("`white_noise`") < first);
  CHECK(first < table.find("`bias_instability`"));
}
