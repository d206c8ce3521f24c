// What instruments write into their first lines that is neither names nor rows: oscilloscopes of Rigol ("X,CH1,Start,
// Increment," above "Sequence,Volt,-6e-4,1e-6"; "Time(s),CH1V,t0 =-6e-4, tInc = 2e-9,"), wristbands of Empatica (a row
// of the time since 1970, and one of the rate), SignalExpress of NI ("channel names:", "dt:", "data:", and below each
// what it says), recorders of Yokogawa (a key in front of each line, nothing in front of the rows), Nexus of Vicon
// (what follows, "Devices", and a line with its rate).
#include <algorithm>
#include <array>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/header.hpp"
#include "libchar/log/reading_fields.hpp"

namespace libchar::csv {
namespace {

void take_interval(Study& study, std::string_view seconds) {
  const auto interval = parse_double(trimmed(seconds));
  if (interval && *interval > 0 && kRates.lowest * *interval <= 1 && kRates.highest * *interval >= 1)
    study.rate_hz = 1 / *interval;
}

/// The same number in all cells; nothing where it is none.
std::optional<double> one_number(const Study& study, const Line& line) {
  const Cells cells = cells_in(study.dialect, line.text);
  const Cell first = read_cell(cells[0].text, study.dialect.decimal);
  const bool same = std::all_of(cells.begin(), cells.end(),
                                [&](const Field& cell) { return cell.text == cells[0].text && !cell.text.empty(); });
  return same && first.kind == Cell::value ? std::optional(first.number) : std::nullopt;
}

}  // namespace

void take_scope_settings(Study& study) {
  if (study.sample.size() < 3) return;
  Line &names = study.sample[0], &below = study.sample[1];
  const std::size_t start = names.text.find(",Start,Increment");
  if (start != std::string_view::npos) {
    Cells cells = split(below.text, ',');
    const auto count = static_cast<std::size_t>(std::count(
                           names.text.begin(), names.text.begin() + static_cast<std::ptrdiff_t>(start), ',')) +
                       1;
    if (cells.size() < count + 2) return;
    take_interval(study, cells[count + 1].text);
    if (!study.rate_hz) return;
    names.text = names.text.substr(0, start);
    below.text = below.text.substr(0, cells[count].offset - 1);
    return;
  }
  const std::size_t zero = names.text.find(",t0 ="), step = names.text.find("tInc =");
  if (zero == std::string_view::npos || step == std::string_view::npos || step < zero) return;
  take_interval(study, names.text.substr(step + 6, names.text.find(',', step) - step - 6));
  if (!study.rate_hz) return;
  const std::string_view row = below.text;  // as many empty cells as the rows end with
  study.names = std::string(names.text.substr(0, zero)) + std::string(row.size() - 1 - row.find_last_not_of(','), ',');
  names.text = study.names;
}

void take_rate_of_nexus(Study& study) {
  static constexpr std::array<std::string_view, 5> kKinds = {"Devices", "Trajectories", "Model Outputs", "Joints",
                                                             "Segments"};
  if (study.sample.size() < 4) return;
  const auto only = [&](std::size_t line) {  // the first cell, where there is no other
    const std::string_view text = trimmed(study.sample[line].text);
    return trimmed(text.substr(0, text.find_last_not_of(",;\t ") + 1));  // npos + 1 is 0
  };
  const auto rate = parse_double(only(1));
  if (std::find(kKinds.begin(), kKinds.end(), only(0)) == kKinds.end() || !rate || *rate < kRates.lowest ||
      *rate > kRates.highest)
    return;
  study.rate_hz = *rate;
  study.sample.erase(study.sample.begin(), study.sample.begin() + 2);
  study.info.dialect.emplace_back("the rate in line 2, as of Nexus");
}

bool named_by_signal_express(Study& study) {
  const std::vector<Line> lines = study.sample;
  const auto at = [&](std::string_view key) {
    return static_cast<std::size_t>(
        std::find_if(lines.begin(), lines.end(), [&](const Line& line) { return trimmed(line.text) == key; }) -
        lines.begin());
  };
  const std::size_t step = at("dt:"), data = at("data:");
  if (at("channel names:") != 0 || data + 1 >= lines.size() || step >= data) return false;
  take_interval(study, split(lines[step + 1].text, study.dialect.delimiter)[0].text);
  study.preamble.assign(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(data) + 1);
  study.sample.erase(study.sample.begin(), study.sample.begin() + static_cast<std::ptrdiff_t>(data) + 1);
  study.dialect.data_offset = lines[data].after;
  study.dialect.first_data_line = lines[data].number + lines[data].lines;
  read_names(study, lines[1], lines[1].text);
  return true;
}

bool named_by_yokogawa(Study& study) {
  const std::vector<Line> lines = study.sample;
  if (lines.empty() || lines[0].text.find("Header Size") == std::string_view::npos) return false;
  const auto at = [&](std::string_view key) {
    return static_cast<std::size_t>(
        std::find_if(lines.begin(), lines.end(),
                     [&](const Line& line) { return split(line.text, ',')[0].text == key; }) -
        lines.begin());
  };
  const std::size_t names = at("TraceName"), units = at("VUnit");
  const auto is_row = [](const Line& line) {  // names stand there again, with a line of their own between
    const Cells cells = split(line.text, ',');
    return cells.size() > 1 && cells[0].text.empty() && read_cell(cells[1].text, '.').kind == Cell::value;
  };
  const auto data = static_cast<std::size_t>(std::find_if(lines.begin(), lines.end(), is_row) - lines.begin());
  if (at("Header Size") != 0 || names >= data || data >= lines.size()) return false;
  study.preamble.assign(lines.begin(), lines.begin() + static_cast<std::ptrdiff_t>(data));
  study.sample.erase(study.sample.begin(), study.sample.begin() + static_cast<std::ptrdiff_t>(data));
  study.dialect.data_offset = lines[data].offset;
  study.dialect.first_data_line = lines[data].number;
  const std::string_view text = lines[names].text;
  const Cells row = cells_in(study.dialect, lines[data].text);
  study.columns -= row.size() == study.columns && row.back().text.empty() ? 1 : 0;
  read_names(study, lines[names], text.substr(text.find(',')));
  if (units >= data) return true;
  read_units(study, lines[units]);
  study.dialect.columns[0].unit_below.clear();  // "VUnit"
  return true;
}

bool begins_with_rate(Study& study) {
  constexpr double kFirst = 1e9, kLast = 2.2e9, kFastest = 4096;
  if (study.sample.size() < 4 || !study.dialect.lead.empty()) return false;
  const auto time = one_number(study, study.sample[0]), rate = one_number(study, study.sample[1]);
  const Cell value = read_cell(cells_in(study.dialect, study.sample[2].text)[0].text, study.dialect.decimal);
  if (!time || *time < kFirst || *time > kLast || !rate || *rate < kRates.lowest || *rate > kFastest ||
      value.kind != Cell::value || value.number > kFirst)
    return false;
  study.rate_hz = *rate;
  study.preamble.assign(study.sample.begin(), study.sample.begin() + 2);
  study.sample.erase(study.sample.begin(), study.sample.begin() + 2);
  study.info.dialect.emplace_back("the time and the rate in the first two rows");
  study.dialect.data_offset = study.sample[0].offset;
  study.dialect.first_data_line = study.sample[0].number;
  do_without_names(study);
  return true;
}

}  // namespace libchar::csv
