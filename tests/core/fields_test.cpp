// One description of a document: what its rows read, write and say in a table.

#include "libchar/core/document/fields.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/document/document.hpp"
#include "libchar/core/error.hpp"

using namespace libchar;

namespace {

enum class Colour { red, green };
constexpr Word kColours[] = {{"red", 0}, {"green", 1, "the usual one"}};

enum class Socket { e14, e27 };

}  // namespace

template <>
inline constexpr auto libchar::enum_table<Socket> = std::to_array<EnumWord<Socket>>({{Socket::e27, "E27"},
                                                                                     {Socket::e14, "E14"}});

namespace {

struct Lamp {
  double power_w = 5;
  Colour colour = Colour::red;
  bool operator==(const Lamp&) const = default;
};

struct Room {
  std::string name;
  std::uint64_t doors = 1;
  std::optional<double> height_m;
  std::vector<double> widths_m;
  Lamp lamp;
  Socket socket = Socket::e27;
  bool open = false;
};

const Fields<Lamp>& lamp_fields() {
  static const Fields<Lamp> rows = {
      field<&Lamp::power_w>("power_w", {.unit = "W", .range = kPositive, .meaning = "at 230 V"}),
      field<&Lamp::colour>("colour", {.words = kColours, .meaning = "of the light"}),
  };
  return rows;
}

const Fields<Room>& room_fields() {
  static const Fields<Room> rows = {
      field<&Room::name>("name", {.meaning = "unique", .written = Written::always, .required = true}),
      field<&Room::doors>("doors", {.comment = "for {name}", .written = Written::always}),
      empty_line<Room>(),
      field<&Room::height_m>("height_m", {.range = kPositive}),
      field<&Room::widths_m>("widths_m"),
      part<&Room::lamp>("lamp", lamp_fields(), {.form = Entry::Form::flow}),
      field<&Room::lamp, &Lamp::colour>("light", {.words = kColours}),
      field<&Room::socket>("socket"),
      field<&Room::open>("open"),
  };
  return rows;
}

Room read(const std::string& text, const std::string& file = "f.yaml") {
  const Document document = parse_document(text, file);
  Room room;
  read_fields(room_fields(), MapReader(document, file, "", keys_of(room_fields())), room);
  return room;
}

std::string field_refusal(const std::string& text, const std::string& file = "f.yaml") {
  try {
    read(text, file);
  } catch (const Error& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace

TEST_CASE("fields: what is written reads back, in YAML and in JSON") {
  Room room;
  room.name = "hall";
  room.height_m = 0.1;
  room.widths_m = {1, 1.0 / 3};
  room.lamp = {7, Colour::green};
  room.open = true;
  const std::vector<Entry> entries = entries_of(room_fields(), room, {{"name", "people"}});
  const std::string yaml = yaml_of(entries);
  CHECK(yaml ==
        "name: \"hall\"\ndoors: 1  # for people\n\nheight_m: 0.1\nwidths_m: [1.0, 0.3333333333333333]\nlamp: {power_w: "
        "7.0, colour: green}\nlight: green  # the usual one\nopen: true\n");
  CHECK(yaml_of(entries, "  ", false).starts_with("  name: \"hall\"\n  doors: 1\n  height_m: 0.1\n"));
  for (const bool json : {false, true}) {
    const Room back = json ? read(dump_json(json_of(entries)), "f.json") : read(yaml);
    CHECK(back.name == room.name);
    CHECK(back.height_m == room.height_m);
    CHECK(back.widths_m == room.widths_m);
    CHECK(back.lamp == room.lamp);
    CHECK(back.open);
  }
}

TEST_CASE("fields: what is as usual is not written, and absent keys leave what is there") {
  CHECK(yaml_of(entries_of(room_fields(), Room{})) == "name: \"\"\ndoors: 1  # for {name}\n");
  CHECK(read("name: a\n").lamp == Lamp{});
  CHECK(json_of(entries_of(selected(room_fields(), {"open", "doors"}, Written::always), Room{})).dump() ==
        R"({"open":false,"doors":1})");
}

TEST_CASE("fields: refusals name line, column and the nearest key or word") {
  CHECK(field_refusal("doors: 2\n") == "f.yaml:1:1: error E0542: name is missing");
  CHECK(field_refusal("name: a\nlamp: {powr_w: 1}\n") ==
        "f.yaml:2:8: error E0540: unknown key in lamp; got \"powr_w\"; hint: did you mean power_w?");
  CHECK(field_refusal("{\"name\": \"a\",\n \"light\": \"gren\"}", "f.json")
            .starts_with("f.json:2:11: error E0544: light: expected one of red, green"));
  CHECK(field_refusal("name: a\nheight_m: 0\n").starts_with("f.yaml:2:11: error E0543"));
  CHECK(field_refusal("name: a\nopen: 1\n").starts_with("f.yaml:2:7: error E0541"));
}

TEST_CASE("fields: yes and no may have words of their own") {
  struct Door {
    bool ajar = false;
  };
  static constexpr Word kDoors[] = {{"shut", 0}, {"ajar", 1}};
  const Fields<Door> rows = {field<&Door::ajar>("door", {.words = kDoors})};
  for (const bool ajar : {false, true}) {
    Door door{ajar};
    const std::string yaml = yaml_of(entries_of(selected(rows, {"door"}, Written::always), door));
    CHECK(yaml == (ajar ? "door: ajar\n" : "door: shut\n"));
    Door back{!ajar};
    const Document document = parse_yaml_document(yaml, "f");
    read_fields(rows, MapReader(document, "f", "", keys_of(rows)), back);
    CHECK(back.ajar == ajar);
  }
}

TEST_CASE("fields: the words of an enum with a table need no second list") {
  Room room = read("name: a\nsocket: E14\n");
  CHECK(room.socket == Socket::e14);
  CHECK(yaml_of(entries_of(selected(room_fields(), {"socket"}, Written::always), room)) == "socket: E14\n");
  CHECK(
      field_refusal("name: a\nsocket: E17\n").starts_with("f.yaml:2:9: error E0544: socket: expected one of E27, E14"));
  CHECK(markdown_table(selected(room_fields(), {"socket"}, Written::always)).ends_with("| `socket` | E27, E14 |  |\n"));
}

TEST_CASE("fields: the table of a page has a row a key") {
  CHECK(markdown_table(lamp_fields()) ==
        "| key | value | meaning |\n|---|---|---|\n| `power_w` | W | at 230 V |\n| `colour` | red, green | of the "
        "light |\n");
}

namespace {

struct Reading {
  double time_s = 0;
  double value = 0;
  bool sure = true;
  Interval ci95;
  double weight = 1;
  bool operator==(const Reading&) const = default;
};

struct Meter {
  std::string name;
  std::optional<double> offset;
  std::vector<Reading> readings;
  std::vector<Lamp> lamps;
  std::optional<Lamp> spare;
  std::vector<Interval> pauses_s;
  int turns = 0;
};

bool has_weight(const Reading& reading) { return reading.ci95.high > 0; }

const Fields<Reading>& reading_rows() {
  static const Fields<Reading> rows = joined(always(Fields<Reading>{
                                                 field<&Reading::time_s>("time_s"),
                                                 field<&Reading::value>("value"),
                                                 field<&Reading::sure>("sure"),
                                                 field<&Reading::ci95>("ci95", {.known = when<has_weight>}),
                                             }),
                                             {field<&Reading::weight>("weight")});
  return rows;
}

const Fields<Meter>& meter_fields() {
  static const Fields<Meter> rows = always(Fields<Meter>{
      field<&Meter::name>("name"),
      constant<Meter>("unit", "{unit}"),
      field<&Meter::offset>("offset"),
      columns_of<&Meter::readings>("", reading_rows()),
      list_of<&Meter::lamps>("lamps", always(lamp_fields())),
      maybe_part<&Meter::spare>("spare", always(lamp_fields())),
      field<&Meter::pauses_s>("pauses_s"),
      field<&Meter::turns>(
          "turns", {.written = Written::if_known, .known = when<[](const Meter& meter) { return meter.turns != 0; }>}),
      computed<[](const Meter& meter) { return std::uint64_t{meter.lamps.size()}; }>("count"),
  });
  return rows;
}

Meter read_meter(const std::string& text) {
  const Document document = parse_document(text, "m.json");
  Meter meter;
  read_fields(meter_fields(), MapReader(document, "m.json", ""), meter);
  return meter;
}

}  // namespace

TEST_CASE("fields: lists, columns and parts that need not be there read back to the same bits") {
  Meter meter;
  meter.name = "m";
  meter.readings = {{0.1, 1.0 / 3, true, {0.25, INFINITY}, 1}, {0.2, NAN, false, {0, 0}, 1}};
  meter.lamps = {{7, Colour::green}, {}};
  meter.pauses_s = {{1, 2}, {NAN, NAN}};
  const Json json = json_of(entries_of(meter_fields(), meter, {{"unit", "deg"}}));
  CHECK(json.dump() == R"({"name":"m","unit":"deg","offset":null,"time_s":[0.1,0.2],)"
                       R"("value":[0.3333333333333333,null],"sure":[true,false],"ci95":[[0.25,null],null],)"
                       R"("lamps":[{"power_w":7.0,"colour":"green"},{"power_w":5.0,"colour":"red"}],)"
                       R"("spare":null,"pauses_s":[[1.0,2.0],null],"count":2})");
  const Meter back = read_meter(dump_json(json));
  CHECK(back.readings[0] == meter.readings[0]);
  CHECK(std::isnan(back.readings[1].value));
  CHECK(back.readings[1].ci95 == Interval{});
  CHECK(back.lamps == meter.lamps);
  CHECK_FALSE(back.spare);
  CHECK(back.pauses_s[0] == meter.pauses_s[0]);
  meter.spare = Lamp{9, Colour::red};
  meter.readings[1].weight = 2;
  meter.turns = -3;
  const Json more = document_of(meter_fields(), meter);
  CHECK(more["weight"].dump() == "[1.0,2.0]");
  CHECK(read_meter(dump_json(more)).spare == meter.spare);
  CHECK(read_meter(dump_json(more)).turns == -3);
}

TEST_CASE("fields: columns of different lengths and other values are refused with their place") {
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      read_meter(text);
    } catch (const Error& error) {
      return error.what();
    }
    return "accepted";
  };
  CHECK(refusal(R"({"name": "m", "a key of a later version": {"a": 1}})") == "accepted");
  CHECK(refusal("{\"time_s\": [1, 2],\n \"value\": [1]}")
            .starts_with("m.json:2:11: error E0982: value: 1 values, 2 expected"));
  CHECK(refusal(R"({"time_s": [1, "x"]})").find("a number was expected") != std::string::npos);
  CHECK(refusal(R"({"pauses_s": [[2, 1]]})").find("E0543") != std::string::npos);
}

TEST_CASE("fields: the schema says types, words and what is always there") {
  const Json schema = schema_of(meter_fields().rows);
  CHECK(schema["required"].dump() ==
        R"(["name","unit","offset","time_s","value","sure","ci95","lamps","spare","pauses_s","count"])");
  CHECK(schema["properties"]["unit"].dump() == R"({"type":"string"})");
  CHECK(schema["properties"]["sure"].dump() == R"({"type":"array","items":{"type":"boolean"}})");
  CHECK(schema["properties"]["spare"]["type"].dump() == R"(["object","null"])");
  CHECK(schema["properties"]["lamps"]["items"]["properties"]["colour"]["enum"].dump() == R"(["red","green"])");
  CHECK(schema["properties"]["lamps"]["items"]["properties"]["power_w"]["description"] == "at 230 V, in W");
  CHECK(schema["properties"]["turns"].dump() == R"({"type":"integer"})");
}

namespace {

struct Gauge {
  double level = 1, most = 5;
  std::vector<std::vector<double>> series;
};

struct NamedGauge : Gauge {
  std::string note;
  Interval ci95{0, 1};
};

const Fields<NamedGauge>& gauge_fields() {
  using T = NamedGauge;
  static const Fields<T> rows = always(Fields<T>{
      field<&T::level>("level"),
      field<&T::most>("most", {.known = when<[](const T& g) { return std::isfinite(g.most); }>}),
      field<&T::series>("series"),
      field_or_null<&T::note>("note"),
      field<&T::ci95>("ci95"),
  });
  return rows;
}

}  // namespace

TEST_CASE("fields: rows of a base class, lists of lists, and what null says in a report") {
  NamedGauge gauge;
  gauge.level = NAN;
  gauge.most = INFINITY;
  gauge.series = {{1, NAN}, {}};
  gauge.ci95 = {-INFINITY, 2};
  const Json json = document_of(gauge_fields(), gauge);
  CHECK(json.dump() == R"({"level":null,"most":null,"series":[[1.0,null],[]],"note":null,"ci95":[null,2.0]})");
  const Document document = parse_document(dump_json(json), "g.json");
  NamedGauge back;
  read_fields(gauge_fields(), MapReader(document, "g.json", ""), back);
  CHECK(std::isnan(back.level));
  CHECK(back.most == 5);  // its row says what null means
  REQUIRE(back.series.size() == 2);
  CHECK(back.series[0][0] == 1);
  CHECK(std::isnan(back.series[0][1]));
  CHECK(back.note.empty());
  CHECK(back.ci95 == gauge.ci95);
  const Json schema = schema_of(gauge_fields().rows);
  CHECK(schema["properties"]["note"]["type"].dump() == R"(["string","null"])");
  CHECK(schema["properties"]["series"]["items"]["items"]["type"].dump() == R"(["number","null"])");
}
