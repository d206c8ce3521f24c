// Every row of fixtures/bad: a text or command line that is wrong or odd in one way, and what must be said of it:
// verdict, exit code, code and place. The rows were written by what is right, not by what the program says.

#include <catch2/catch.hpp>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/support/run.hpp"

namespace {

namespace fs = std::filesystem;

struct BadRow {
  std::string name, verdict, code, place, options, content;
};

/// \n \r \t \\ \xHH; @N@ stands for N digits.
std::string unescaped(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '@') {
      const std::size_t end = text.find('@', i + 1);
      out.append(std::stoul(text.substr(i + 1, end - i - 1)), '1');
      i = end;
    } else if (text[i] == '\\' && text[i + 1] == 'x') {
      out += static_cast<char>(std::stoi(text.substr(i + 2, 2), nullptr, 16));
      i += 3;
    } else if (text[i] == '\\') {
      const char c = text[++i];
      out += c == 'n' ? '\n' : c == 'r' ? '\r' : c == 't' ? '\t' : c;
    } else {
      out += text[i];
    }
  }
  return out;
}

std::vector<BadRow> bad_rows(const std::string& kind) {
  std::ifstream in(test::fixture("bad/" + kind + ".tsv"));
  std::vector<BadRow> rows;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::istringstream cells(line);
    BadRow row;
    for (std::string* cell : {&row.name, &row.verdict, &row.code, &row.place, &row.options, &row.content})
      std::getline(cells, *cell, '\t');
    if (row.options == "-") row.options.clear();
    rows.push_back(row);
  }
  return rows;
}

/// "f8 1 nan 3" and "i8f8 1 2 3 4" (by turns) as little-endian numbers, "x 00ff" as bytes.
std::string numbers(const std::string& text) {
  std::istringstream words(text);
  std::string type, word, bytes;
  words >> type;
  for (std::size_t i = 0; words >> word; ++i) {
    char eight[8];
    if (type == "x") {
      for (std::size_t k = 0; k + 1 < word.size(); k += 2)
        bytes += static_cast<char>(std::stoi(word.substr(k, 2), nullptr, 16));
      continue;
    }
    const bool integer = type[2 * (i % (type.size() / 2))] == 'i' && type[0] == 'i';
    const double real = integer && i % (type.size() / 2) == 0 ? 0 : std::strtod(word.c_str(), nullptr);
    const auto whole = static_cast<std::int64_t>(std::strtoll(word.c_str(), nullptr, 10));
    if (integer)
      std::memcpy(eight, &whole, 8);
    else
      std::memcpy(eight, &real, 8);
    bytes.append(eight, 8);
  }
  return bytes;
}

std::string npy_of(const std::string& content) {
  const std::size_t bar = content.rfind('|');
  const std::string data = numbers(content.substr(bar + 1));
  std::string header = content.substr(0, bar);
  if (header == "RAW") return data;
  header.resize((header.size() + 11 + 63) / 64 * 64 - 11, ' ');
  header += '\n';
  const auto length = static_cast<std::uint16_t>(header.size());
  return std::string("\x93NUMPY\x01\x00", 8) + static_cast<char>(length & 0xFFU) + static_cast<char>(length >> 8U) +
         header + data;
}

void write(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// The files of the row, and the words that look at them; the first input is the last word of
/// `words` before the options.
std::vector<std::string> arranged(const std::string& kind, const BadRow& row, const fs::path& at) {
  const std::string content = unescaped(row.content);
  std::vector<std::string> words;
  if (kind == "csv") {
    write(at / "case.csv", content);
    words = {"inspect", "case.csv", "--json"};
  } else if (kind == "npy") {
    write(at / "case.npy", npy_of(content));
    words = {"inspect", "case.npy", "--json"};
  } else if (kind == "raw") {
    const std::size_t bar = content.rfind('|');
    write(at / "case.f64", numbers(content.substr(bar + 1)));
    if (bar > 0) write(at / "case.f64.json", content.substr(0, bar));
    words = {"inspect", "case.f64", "--json"};
  } else if (kind == "model") {
    write(at / "case.sensor.yaml", content);
    words = {"model", "case.sensor.yaml"};
  } else if (kind == "json") {
    write(at / "case.json", content);
    words = {"model", "case.json"};
  } else if (kind == "scene") {
    write(at / "case.scene.yaml", content);
    words = {"replay", "case.scene.yaml", "--explain"};
  } else if (kind == "limits") {
    write(at / "case.yaml", content);
    words = {"characterize", "good.csv", "--limits", "case.yaml", "-o", "out", "--force", "-q"};
  } else if (kind == "curve") {
    write(at / "case.csv", content);
    words = {"fit", "case.csv", "--curve", "allan"};
  }
  std::istringstream options(row.options);
  for (std::string word; options >> word;) words.push_back(word);
  return words;
}

/// Of the sentence of an error: what stands in front of it, "case.csv:3:5 (byte 17)".
std::string front_of_error(const std::string& err) {
  const std::size_t begin = err.rfind('\n', err.size() - 2);
  const std::string line = err.substr(begin == std::string::npos ? 0 : begin + 1);
  return line.substr(0, line.find(": error "));
}

void check_error(const BadRow& row, const test::Ran& ran) {
  CHECK(std::to_string(ran.code) == row.verdict);
  if (row.code != "-") CHECK_THAT(ran.err, Catch::Contains("error " + row.code + ": "));
  CHECK_THAT(ran.err, Catch::Contains("error E"));
  CHECK(ran.err.find("internal") == std::string::npos);
  const std::string front = front_of_error(ran.err);
  if (row.place == "-") return;
  const bool line_and_column = row.place.find_first_not_of("0123456789:") == std::string::npos;
  if (line_and_column)
    CHECK_THAT(front + " ", Catch::Contains(":" + row.place + " "));
  else
    CHECK_THAT(front, Catch::Contains(row.place));
}

/// "3:5" is "line 3, column 5" of a warning.
std::string place_in_words(const std::string& place) {
  const std::size_t colon = place.find(':');
  if (colon == std::string::npos) return place;
  const std::string column = place.substr(colon + 1);
  return "line " + place.substr(0, colon) + (column == "1" ? "" : ", column " + column);
}

void check_warning(const BadRow& row, const test::Ran& ran) {
  CHECK(ran.code == 0);
  CHECK_THAT(ran.err, Catch::Contains(": warning: ") || Catch::Contains(": note: "));
  bool found = row.code == "-", placed = row.place == "-";
  const auto document = nlohmann::json::parse(ran.out, nullptr, false);
  REQUIRE(document.is_object());
  for (const auto& warning : document["findings"]) {
    if (warning["code"] != row.code && row.code != "-") continue;
    found = true;
    CHECK(warning["count"].get<std::uint64_t>() > 0);
    for (const auto& where : warning["where"]["rows"])
      placed = placed || where.get<std::string>().find(place_in_words(row.place)) == 0;
  }
  INFO(document["findings"].dump());
  CHECK(found);
  CHECK(placed);
}

/// Rows in = rows used + rows dropped with a reason + rows outside the window; samples = rows used + missing ones.
void check_account(const std::string& out) {
  const auto document = nlohmann::json::parse(out);
  for (const auto& log : document["recordings"]) {
    const auto number = [&](const char* key) { return log.at(key).get<std::uint64_t>(); };
    const auto repairs = [&](const char* key) {
      return log["repairs"].contains(key) ? log["repairs"][key].get<std::uint64_t>() : 0;
    };
    CHECK(number("rows") == number("rows_used") + number("rows_dropped") + number("rows_outside"));
    CHECK(number("rows_dropped") ==
          repairs("duplicate_timestamp") + repairs("backward_timestamp") + repairs("wild_stamp") + repairs("own_rows"));
    CHECK(number("samples") == number("rows_used") + number("missing_samples"));
  }
}

}  // namespace

TEST_CASE("every bad input of fixtures/bad gets its verdict, exit code, code and place") {
  const test::TemporaryFolder folder;
  std::ostringstream log;
  log << "t,x\n";
  for (int i = 0; i < 2000; ++i) log << 0.01 * i << ',' << (i * i) % 1009 << '\n';
  std::size_t count = 0;
  for (const char* kind : {"csv", "npy", "raw", "model", "json", "scene", "limits", "curve", "command"}) {
    for (const BadRow& row : bad_rows(kind)) {
      fs::remove_all(folder / "at");
      const fs::path at = folder / "at";
      fs::create_directories(at / "folder");
      write(at / "good.csv", log.str());
      write(at / "model.sensor.yaml",
            "format: sensor-model\nversion: 1\nunit: V\nrate_hz: 100\nwhite_noise: {value: 1, unit: V·√s}\n");
      write(at / "scene.scene.yaml",
            "format: scene\nversion: 1\nsimulate: {rate_hz: 100, duration_s: 1, truth: [{name: r, kind: "
            "zero}]}\nsensors:\n  - {name: a, model: {unit: V}}\n  - {name: b, model: {unit: V}}\n");
      test::RunOptions where;
      where.folder = at.string();
      const auto ran = test::run(arranged(kind, row, at), where);
      INFO(kind << ": " << row.name << "\nexit code " << ran.code << "\n" << ran.err);
      ++count;
      if (row.verdict == "warn") {
        check_warning(row, ran);
      } else if (row.verdict == "ok") {
        CHECK(ran.code == 0);
        CHECK(ran.err.find("warning") == std::string::npos);
      } else {
        check_error(row, ran);
        if (row.code != "E0206") CHECK(ran.out.empty());
      }
      if (ran.code == 0 &&
          (std::strcmp(kind, "csv") == 0 || std::strcmp(kind, "npy") == 0 || std::strcmp(kind, "raw") == 0))
        check_account(ran.out);
    }
  }
  CHECK(count >= 450);
}
