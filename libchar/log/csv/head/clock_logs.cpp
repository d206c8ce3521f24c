// Statistics of time daemons: chrony's logs (chrony.conf(5), "log") and those of ntpd (ntp_monitor, "loopstats" and
// "peerstats"). They have no header, or one whose blanks are not those of the rows.
#include <algorithm>
#include <array>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/header.hpp"

namespace libchar::csv {
namespace {

/// `cells`: a letter for each cell of a row, of which more may follow.
struct ClockLog {
  std::string_view cells, title, names;
};

constexpr std::array kClockLogs = {
    ClockLog{"DTWNNNELNEEEEE", "chrony's tracking log",
             "date,clock,reference,stratum,frequency [ppm],skew [ppm],offset [s],leap,sources,offset_sd [s],remaining "
             "[s],root_delay [s],root_dispersion [s],max_error [s]"},
    ClockLog{"DTWLNNNNNNNEEEEE", "chrony's log of measurements",
             "date,clock,source,leap,stratum,tests_1,tests_2,tests_3,poll,remote_poll,score,offset [s],peer_delay "
             "[s],peer_dispersion [s],root_delay [s],root_dispersion [s],refid,mode,tx,rx"},
    ClockLog{"DTWEEEEEENNN", "chrony's log of statistics",
             "date,clock,source,sd [s],offset [s],offset_sd "
             "[s],frequency_difference,skew,stress,samples,first,runs,asymmetry"},
    ClockLog{"DTWNLNEEE", "chrony's log of reference clocks",
             "date,clock,source,sample,leap,pps,raw_offset [s],offset [s],dispersion [s]"},
    ClockLog{"MSNNNNI", "loopstats of ntpd",
             "MJD,sod,offset [s],frequency [ppm],jitter [s],wander [ppm],time_constant"},
    ClockLog{"MSAWNNNN", "peerstats of ntpd", "MJD,sod,source,status,offset [s],delay [s],dispersion [s],jitter [s]"}};

bool is_cell(const Field& field, char letter) {
  const std::string& text = field.text;
  const CellKind kind = cell_kind(field, {'.'});
  const bool number = kind == CellKind::number || text == "-", whole = text.find_first_of(".eE") == std::string::npos;
  const double value = parse_double(text).value_or(-1);
  constexpr double kFirstDay = 40000, kLastDay = 80000, kDay = 86401, kLongest = 17;
  switch (letter) {
    case 'D':
      return kind == CellKind::date;
    case 'T':
      return kind == CellKind::clock;
    case 'L':
      return text.size() == 1 && std::string_view("N+-?").find(text[0]) != std::string_view::npos;
    case 'E':
      return number && (text == "-" || text.find("e") != std::string::npos);
    case 'M':
      return whole && value >= kFirstDay && value < kLastDay;
    case 'S':
      return !whole && value >= 0 && value < kDay;
    case 'I':
      return whole && value >= 0 && value <= kLongest;
    case 'A':  // an address
      return std::count(text.begin(), text.end(), '.') == 3 || std::count(text.begin(), text.end(), ':') > 1;
    case 'N':
      return number;
    default:
      return !text.empty();
  }
}

bool is_row(const Cells& row, const ClockLog& log, std::size_t names) {
  if (row.size() < log.cells.size() || row.size() > names) return false;
  for (std::size_t c = 0; c < log.cells.size(); ++c)
    if (!is_cell(row[c], log.cells[c])) return false;
  return true;
}

}  // namespace

bool named_by_daemon(Study& study) {
  constexpr std::size_t kLooked = 4;
  if (study.dialect.delimiter != ' ') return false;
  for (const ClockLog& log : kClockLogs) {
    const Cells names = split(log.names, ',');
    if (study.columns > names.size()) continue;
    const std::size_t looked = std::min(kLooked, study.sample.size());
    if (!std::all_of(study.sample.begin(), study.sample.begin() + static_cast<std::ptrdiff_t>(looked),
                     [&](const Line& line) { return is_row(split(line.text, ' '), log, names.size()); }))
      continue;
    study.dialect.has_header = true;
    study.dialect.data_offset = study.sample[0].offset;
    study.dialect.first_data_line = study.sample[0].number;
    for (std::size_t c = 0; c < study.columns; ++c) {
      Column& column = study.dialect.columns.emplace_back();
      column.text = names[c].text;
      column.words = c >= log.cells.size() || std::string_view("WLA").find(log.cells[c]) != std::string_view::npos;
    }
    study.info.dialect.push_back("names and units of " + std::string(log.title));
    return true;
  }
  return false;
}

}  // namespace libchar::csv
