// Units and their names.

#include "libchar/fleet/unit.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "libchar/characterize/settings.hpp"
#include "libchar/core/document/entry.hpp"
#include "libchar/core/error.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

FleetUnit some_unit() {
  FleetUnit unit;
  unit.log = "/logs/\xC3\xA4 1.npy";
  unit.sha256 = std::string(64, 'a');
  unit.bytes = 12345678901;
  unit.device = 7;
  CharacterizeOptions options;
  options.reading.channels = {"gx", "gy"};
  options.reading.rate_hz = 0.1;
  options.fit.terms = {true, false, true, false, true};
  options.spectrum.segment = 4096;
  options.still.stretch_s = Interval{1.5, 20};
  unit.options = std::make_shared<const CharacterizeOptions>(options);
  unit.cost = {1.25, 1000};
  unit.id = unit_id(unit);
  return unit;
}

std::string settings_text(const CharacterizeOptions& options) { return json_of(settings_of(options)).dump(); }

}  // namespace

TEST_CASE("a task reads back as it was written, every setting with it") {
  const FleetUnit unit = some_unit();
  const FleetUnit again = parse_unit(unit_text(unit), "t.json");
  CHECK(again.id == unit.id);
  CHECK(again.log == unit.log);
  CHECK(again.bytes == unit.bytes);
  CHECK(again.device == unit.device);
  CHECK(again.cost.seconds == unit.cost.seconds);
  CHECK(settings_text(*again.options) == settings_text(*unit.options));
  CHECK(again.options->fit.terms == unit.options->fit.terms);
}

TEST_CASE("the name of a unit is that of its content: log, settings, stretch, not of places and costs") {
  const FleetUnit unit = some_unit();
  const auto id_with = [&](auto change) {
    FleetUnit other = unit;
    change(other);
    return unit_id(other);
  };
  CHECK(id_with([](FleetUnit& u) { u.log = "/elsewhere.npy"; }) == unit.id);
  CHECK(id_with([](FleetUnit& u) { u.cost.seconds = 9; }) == unit.id);
  CHECK(id_with([](FleetUnit& u) { u.device = 0; }) == unit.id);
  CHECK(id_with([](FleetUnit& u) { u.sha256[0] = 'b'; }) != unit.id);
  CHECK(id_with([](FleetUnit& u) {
          CharacterizeOptions options = *u.options;
          options.fit.threshold = 6;
          u.options = std::make_shared<const CharacterizeOptions>(options);
        }) != unit.id);
  CHECK(id_with([](FleetUnit& u) { u.reports = false; }) != unit.id);
  CHECK(id_with([](FleetUnit& u) { u.kind = UnitKind::stretch; }) != unit.id);
}

TEST_CASE("stretches without whole ends and joins of what is no result are refused") {
  const auto said = [](UnitKind kind, const std::string& key, const std::string& value) {
    FleetUnit unit = some_unit();
    unit.kind = kind;
    unit.stretch = {0, 1};
    unit.parts = {unit.id};
    Json task = Json::parse(unit_text(unit));
    task[key] = Json::parse(value);
    try {
      parse_unit(task.dump(), "t.json");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  for (const char* leaves : {"[0, 1e300]", "[0.5, 2]", "[1, 1]", "[-1, 1]", "[0]"})
    CHECK_THAT(said(UnitKind::stretch, "leaves", leaves), Contains("first leaf"));
  for (const char* parts : {R"(["../../elsewhere"])", "[]", R"([""])"})
    CHECK_THAT(said(UnitKind::join, "parts", parts), Contains("names of the stretches"));
}

TEST_CASE("a task that was changed by hand, or is of another version, is refused") {
  const std::string text = unit_text(some_unit());
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string other = text;
    const std::size_t at = other.find(from);
    REQUIRE(at != std::string::npos);
    other.replace(at, from.size(), to);
    try {
      parse_unit(other, "t.json");
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  CHECK_THAT(with("\"threshold\":5.41", "\"threshold\":5.42"), Contains("changed after it was planned"));
  CHECK_THAT(with("\"version_of_program\":\"", "\"version_of_program\":\"9"), Contains("another version"));
  CHECK_THAT(with("\"kind\":\"log\"", "\"kind\":\"lgo\""), Contains("did you mean"));
  CHECK_THAT(with("fleet-task", "fleet-tusk"), Contains("fleet-task"));
}
