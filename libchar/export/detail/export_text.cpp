#include "libchar/export/detail/export_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <nlohmann/json.hpp>
#include <utility>

#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/export/detail/consumer_rows.hpp"

namespace libchar {
namespace {

struct Source {
  std::string file, sha256;
};

// The recordings behind the models, each once.
std::vector<Source> sources(const SensorGroup& group) {
  std::vector<Source> out;
  for (const SensorModel* m : group.all) {
    const Source source{m->recording.file, m->recording.sha256};
    const bool known = std::any_of(out.begin(), out.end(),
                                   [&](const Source& s) { return s.sha256 == source.sha256 && s.file == source.file; });
    if (!known) out.push_back(source);
  }
  return out;
}

std::string said(const Source& source, const SensorGroup& group) {
  if (!source.sha256.empty())
    return fmt::format("{} sha256:{}", source.file.empty() ? "a recording" : source.file, source.sha256);
  for (const SensorModel* m : group.all)
    if (m->recording.sha256.empty() && !m->obtained.empty()) return m->obtained + " (no recording)";
  return "no recording";
}

std::string axes_said(AxisChoice axes) {
  switch (axes) {
    case AxisChoice::automatic:
      return "";
    case AxisChoice::max:
      return "axes: the largest stands for all";
    case AxisChoice::rms:
      return "axes: their root mean square stands for all";
    default:
      return fmt::format("axes: {} stands for all", "xyz"[static_cast<int>(axes) - static_cast<int>(AxisChoice::x)]);
  }
}

}  // namespace

std::string export_number(double value) { return shortest_yaml(rounded(value, 10)); }

std::string export_list(const std::array<double, 3>& values) {
  return fmt::format("[{}, {}, {}]", export_number(values[0]), export_number(values[1]), export_number(values[2]));
}

double value_or_zero(const ExportFigure& figure) { return figure.value.value_or(0); }

namespace {

/// What readings of a number or a unit hold besides ASCII, in ASCII.
std::string in_ascii(std::string text) {
  constexpr std::pair<std::string_view, std::string_view> kSpelt[] = {
      {"×10", "e"}, {"×", "x"},     {"±", "+/-"},  {"⁻", "-"},   {"⁰", "0"},     {"¹", "1"},     {"²", "2"},
      {"³", "3"},   {"⁴", "4"},     {"⁵", "5"},    {"⁶", "6"},   {"⁷", "7"},     {"⁸", "8"},     {"⁹", "9"},
      {"µ", "u"},   {"√", "sqrt "}, {"°", "deg "}, {"·", "*"},   {"≤", "<="},    {"≥", ">="},    {"…", ".."},
      {"–", "-"},   {"−", "-"},     {"χ", "chi"},  {"τ", "tau"}, {"σ", "sigma"}, {"\u202F", " "}};
  for (const auto& [from, to] : kSpelt)
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
  return text;
}

}  // namespace

std::string comment_text(std::string_view text) {
  std::string out;
  for (const char c : in_ascii(printable(text))) {
    const bool ascii = static_cast<unsigned char>(c) < 0x80;
    // One mark for each character outside ASCII, not one a byte.
    if (!ascii && (static_cast<unsigned char>(c) & 0xC0U) == 0x80U) continue;
    if (c == '-' && !out.empty() && out.back() == '-') out += ' ';
    out += ascii ? c : '?';
  }
  while (!out.empty() && (out.back() == '\\' || out.back() == ' ')) out.pop_back();
  if (!out.empty() && out.back() == '-') out += '.';
  return out;
}

std::vector<std::string> head_lines(const SensorGroup& group, const ExportOptions& options, std::string_view formula) {
  std::vector<std::string> lines = {fmt::format("sensorchar {}", version())};
  for (const Source& source : sources(group)) lines.push_back("source: " + comment_text(said(source, group)));
  std::string channels;
  for (const SensorModel* m : group.all) channels += (channels.empty() ? "" : ", ") + printable(m->channel, 40);
  lines.push_back("channels: " + comment_text(channels));
  lines.push_back(fmt::format("formula: {}", formula));
  for (const std::string& line : group.unexpressed) lines.push_back(comment_text(line));
  const std::string axes = axes_said(options.axes);
  if (!axes.empty()) lines.push_back(axes);
  if (options.inflate != 1)
    lines.push_back(fmt::format("every noise number is multiplied by {}", export_number(options.inflate)));
  return lines;
}

Json head_json(const SensorGroup& group, const ExportOptions& options, std::string_view formula) {
  Json head = Json::object();
  head["version"] = std::string(version());
  head["recordings"] = Json::array();
  for (const Source& source : sources(group))
    head["recordings"].push_back({{"file", printable(source.file)}, {"sha256", source.sha256}});
  head["channels"] = Json::array();
  for (const SensorModel* m : group.all) head["channels"].push_back(printable(m->channel));
  head["formula"] = std::string(formula);
  const std::string axes = axes_said(options.axes);
  if (!axes.empty()) head["axes"] = axes;
  if (!group.unexpressed.empty()) head["unexpressed"] = group.unexpressed;
  if (options.inflate != 1) head["inflate"] = options.inflate;
  return head;
}

std::string commented(const std::vector<std::string>& lines, std::string_view mark) {
  std::string out;
  for (const std::string& line : lines) out += fmt::format("{}{}\n", mark, line);
  return out;
}

std::string unit_and_origin(const std::string& unit, const std::string& origin) {
  return origin.empty() ? unit : unit + "; " + origin;
}

std::string yaml_line(std::string_view key, double value, std::string_view unit, const std::string& origin) {
  return fmt::format("{}: {}  # {}\n", key, export_number(value), unit_and_origin(std::string(unit), origin));
}

std::string row_lines(std::string_view target, const ImuFigures& f, std::string_view indent) {
  std::string out;
  for (const char* sensor : {"accelerometer", "gyroscope"})
    for (const ConsumerRow* row : rows_of(target, sensor)) {
      const ExportFigure& figure = figure_of(f, sensor, row->term);
      const double rate_hz = std::string_view(sensor) == "gyroscope" ? f.gyroscope_rate_hz : f.accelerometer_rate_hz;
      const double value = row_value(*row, *figure.value, {.rate_hz = rate_hz});
      std::string origin = figure.origin;
      // Its numbers are those of the model: where the file has another function of them, their name comes first.
      if (!origin.empty() && value != *figure.value)
        origin = fmt::format("{}: {}", kTermNames[static_cast<std::size_t>(row->term)].key, origin);
      out += indent;
      out += yaml_line(row->key, value, file_unit(*row), origin);
    }
  return out;
}

std::string axis_origins(const std::array<std::string, 3>& origins) {
  if (origins[0] == origins[1] && origins[1] == origins[2]) return origins[0];
  std::string out;
  for (std::size_t i = 0; i < 3; ++i)
    if (!origins[i].empty()) out += fmt::format("{}{} {}", out.empty() ? "" : "; ", "xyz"[i], origins[i]);
  return out;
}

RowOfAxes white_of_axes(std::string_view target, const SensorTriad& triad, Absent absent, const ExportOptions& options,
                        std::vector<std::string>& notes, const RowTimes& times) {
  const ConsumerRow& row = row_of(target, triad.kind, Term::white);
  const auto figures = axis_figures(triad, Term::white, absent, options);
  RowOfAxes out{std::string(row.key), {}, {}};
  std::array<std::string, 3> origins;
  for (std::size_t i = 0; i < 3; ++i) {
    out.values[i] = row_value(row, value_or_zero(figures[i]), times);
    note_figure(notes, row.key, figures[i]);
    origins[i] = figures[i].origin;
  }
  out.comment = unit_and_origin(file_unit(row), axis_origins(origins));
  return out;
}

BiasOfAxes bias_of_axes(const SensorTriad& triad, const ExportOptions& options, double factor, std::string_view key,
                        std::vector<std::string>& notes) {
  const bool one = options.axes != AxisChoice::automatic;
  BiasOfAxes out;
  std::array<std::string, 3> origins;
  for (std::size_t i = 0; i < 3; ++i) {
    const PlacedModel& placed = one ? representative(triad, options) : *triad.axis[i];
    const GaussMarkov process = one ? gauss_markov_scalar(triad, options) : gauss_markov(placed, options);
    out.model[i] = placed.model;
    out.to_unit[i] = placed.to_si * factor;
    out.steady_sd[i] = process.steady_sd * factor;
    out.correlation_s[i] = process.correlation_s;
    origins[i] = process.origin;
    if (process.driving == 0) notes.push_back(fmt::format("{} {}: 0 ({})", key, "xyz"[i], process.origin));
  }
  out.origins = axis_origins(origins);
  return out;
}

void note_figure(std::vector<std::string>& notes, std::string_view key, const ExportFigure& figure) {
  if (figure.limit)
    notes.push_back(fmt::format("{}: an upper 95 % limit stands for a term that was not detected", key));
  else if (!figure.value)
    notes.push_back(fmt::format("{}: left out ({})", key, figure.origin));
  else if (*figure.value == 0)
    notes.push_back(fmt::format("{}: {}", key, figure.origin));
}

std::string topic_scalar(const SensorGroup& group, const ExportOptions& options) {
  std::string topic = options.topic;
  for (const SensorModel* m : group.all)
    if (topic.empty()) topic = m->recording.topic;
  if (topic.empty()) topic = "/imu0";
  const auto allowed = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '/' || c == '~'; };
  const bool fine = !topic.empty() && std::isdigit(static_cast<unsigned char>(topic[0])) == 0 &&
                    std::all_of(topic.begin(), topic.end(), allowed);
  if (!fine)
    throw usage_error("E0589", "`topic`")
        .says("a ROS topic is made of letters, digits, _ and /, and does not begin with a digit")
        .got(topic)
        .hint("such as /imu0");
  // "~" and "on" would be no texts.
  return topic[0] == '/' ? topic : '"' + topic + '"';
}

}  // namespace libchar
