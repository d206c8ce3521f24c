#include "libchar/fit/curve_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "libchar/core/error.hpp"
#include "libchar/core/sha256.hpp"
#include "libchar/core/text.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{16} << 20U;

using Row = std::vector<std::string>;

// Quotes around a cell are taken off; a doubled quote inside is one.
Row cells_of(std::string_view line, char delimiter) {
  Row cells(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"') {
      cells.back() += line[++i];
    } else if (c == '"') {
      quoted = !quoted;
    } else if (c == delimiter && !quoted) {
      cells.emplace_back();
    } else if (c != '\r') {
      cells.back() += c;
    }
  }
  for (std::string& cell : cells) {
    const std::size_t first = cell.find_first_not_of(" \t"), last = cell.find_last_not_of(" \t");
    cell = first == std::string::npos ? "" : cell.substr(first, last - first + 1);
  }
  return cells;
}

// "Tau [s]" and "tau" are the same name.
std::string plain_name(std::string name) {
  name.resize(std::min({name.find('['), name.find('('), name.size()}));
  while (!name.empty() && name.back() == ' ') name.pop_back();
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return name;
}

std::optional<std::size_t> find(const Row& header, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    for (std::size_t c = 0; c < header.size(); ++c)
      if (plain_name(header[c]) == name) return c;
  return std::nullopt;
}

// "(deg/s)²/Hz" and "g/√Hz" are densities of a channel in deg/s and g.
std::string unit_under_density(std::string unit) {
  for (const std::string_view end : {"²/Hz", "^2/Hz", "/√Hz", "/sqrt(Hz)"}) {
    if (!unit.ends_with(end)) continue;
    unit.resize(unit.size() - end.size());
    if (unit.starts_with('(') && unit.ends_with(')')) unit = unit.substr(1, unit.size() - 2);
  }
  return unit;
}

struct Columns {
  std::optional<std::size_t> x, root, power, channel, unit, kind, dof, low, high, relative,
      absolute;
  bool percent = false;  // the relative error is written in percent
};

Columns columns_of(const Row& header, bool is_allan) {
  Columns c;
  if (is_allan) {
    c.x = find(header, {"tau_s", "tau", "averaging_time", "x"});
    c.root = find(header, {"deviation", "adev", "oadev", "allan_deviation", "sigma", "value"});
    c.power = find(header, {"avar", "variance", "allan_variance"});
  } else {
    c.x = find(header, {"frequency_hz", "frequency", "freq", "f", "x"});
    c.root = find(header, {"lsd", "asd"});
    c.power = find(header, {"psd", "value", "density"});
  }
  c.channel = find(header, {"channel", "name", "axis", "sensor"});
  c.unit = find(header, {"unit"});
  c.kind = find(header, {"curve"});
  c.dof = find(header, {"edf", "dof"});
  c.low = find(header, {"low68"});
  c.high = find(header, {"high68"});
  c.relative = find(header,
                    {"rel_err",
                     "relative_error",
                     "rel_error",
                     "relative error",
                     "relative_sd",
                     "rel_sd",
                     "relative_uncertainty",
                     "rel_unc"});
  c.percent = c.relative && header[*c.relative].find('%') != std::string::npos;
  c.absolute = find(header,
                    {"error",
                     "err",
                     "sd",
                     "std",
                     "stderr",
                     "standard_error",
                     "standard error",
                     "uncertainty",
                     "deviation_sd",
                     "dev_err"});
  return c;
}

std::string whole_text(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error({ErrorKind::input, "E0101", path, "cannot be opened", "", ""});
  std::string text(kMaxBytes + 1, '\0');
  in.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(in.gcount()));
  if (text.size() > kMaxBytes)
    throw Error({ErrorKind::input,
                 "E0801",
                 path,
                 fmt::format("a table of curves of more than {} bytes", kMaxBytes),
                 "",
                 "is this a log? then leave --curve out"});
  return text;
}

// One row into its curve; the place is of the cell that does not fit.
class Reader {
 public:
  Reader(std::string file, const Columns& columns, std::size_t width, bool is_allan)
      : file_(std::move(file)), columns_(columns), width_(width), is_allan_(is_allan) {}

  void take(const Row& row, std::size_t line) {
    line_ = line;
    if (row.size() != width_)
      throw Error({ErrorKind::input,
                   "E0304",
                   fmt::format("{}:{}:1", file_, line),
                   fmt::format("{} fields, {} expected", row.size(), width_),
                   "",
                   ""});
    if (columns_.kind && is_allan_ != (row[*columns_.kind].find("dev") != std::string::npos ||
                                       row[*columns_.kind] == "allan"))
      return;
    NamedCurve& target = curve_of(columns_.channel ? row[*columns_.channel] : "curve",
                                  columns_.unit ? unit_under_density(row[*columns_.unit]) : "");
    const bool by_root = columns_.root.has_value();
    const double x = number(row, *columns_.x),
                 y = number(row, by_root ? *columns_.root : *columns_.power);
    if (x <= 0) return;  // the spectrum at zero frequency says nothing about noise
    target.curve.root = by_root;
    target.curve.x.push_back(x);
    target.curve.y.push_back(y);
    if (const auto sd = relative_sd(row, y)) target.curve.relative_sd.push_back(*sd);
  }

  std::vector<NamedCurve> finish() {
    for (NamedCurve& named : curves_)
      if (named.curve.relative_sd.size() != named.curve.x.size()) named.curve.relative_sd.clear();
    return std::move(curves_);
  }

 private:
  double number(const Row& row, std::size_t c) const {
    if (const auto value = parse_double(row[c])) return *value;
    std::size_t column = 1;
    for (std::size_t i = 0; i < c; ++i) column += row[i].size() + 1;
    throw Error({ErrorKind::input,
                 "E0311",
                 fmt::format("{}:{}:{}", file_, line_, column),
                 "a number was expected",
                 row[c],
                 ""});
  }

  // Of the deviation (root), to first order half of the relative sd of its square, which is sqrt(2 / edf) for chi-square.
  std::optional<double> relative_sd(const Row& row, double y) const {
    const auto cell = [&](const std::optional<std::size_t>& column) {
      return column ? parse_double(row[*column]) : std::nullopt;
    };
    if (const auto dof = cell(columns_.dof); dof && *dof > 0) return 1 / std::sqrt(2 * *dof);
    const double of_root = columns_.root ? 1 : 0.5;
    const auto low = cell(columns_.low), high = cell(columns_.high);
    if (low && high && y > 0 && *high > *low) return of_root * (*high - *low) / (2 * y);
    if (const auto sd = cell(columns_.relative); sd && *sd > 0)
      return of_root * *sd * (columns_.percent ? 0.01 : 1);
    if (const auto sd = cell(columns_.absolute); sd && *sd > 0 && y > 0) return of_root * *sd / y;
    return std::nullopt;
  }

  NamedCurve& curve_of(const std::string& name, const std::string& unit) {
    const auto found = std::find_if(
        curves_.begin(), curves_.end(), [&](const NamedCurve& c) { return c.name == name; });
    if (found != curves_.end()) return *found;
    curves_.push_back({name, unit, {}});
    curves_.back().curve.is_allan = is_allan_;
    return curves_.back();
  }

  std::string file_;
  Columns columns_;
  std::size_t width_, line_ = 0;
  bool is_allan_;
  std::vector<NamedCurve> curves_;
};

}  // namespace

std::optional<CurveTable> read_curve_table(const std::string& path, bool is_allan) {
  const std::string text = whole_text(path);
  std::optional<Reader> reader;
  char delimiter = ',';
  std::size_t line = 0;
  for (std::size_t at = text.starts_with("\xEF\xBB\xBF") ? 3 : 0; at < text.size();) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view row(text.data() + at, end - at);
    at = end + 1;
    ++line;
    if (row.find_first_not_of(" \t\r") == std::string_view::npos || row[0] == '#') continue;
    if (reader) {
      reader->take(cells_of(row, delimiter), line);
      continue;
    }
    for (const char candidate : {'\t', ';', ','})
      if (row.find(candidate) != std::string_view::npos) delimiter = candidate;
    const Row header = cells_of(row, delimiter);
    const Columns columns = columns_of(header, is_allan);
    if (!columns.x || !(columns.root || columns.power)) return std::nullopt;
    reader.emplace(path, columns, header.size(), is_allan);
  }
  if (!reader) return std::nullopt;
  auto curves = reader->finish();
  if (curves.empty())
    throw Error({ErrorKind::input,
                 "E0802",
                 path,
                 is_allan ? "the table holds no Allan curve" : "the table holds no spectrum",
                 "",
                 is_allan ? "--curve psd?" : "--curve allan?"});
  Sha256 hash;
  hash.update(text);
  return CurveTable{std::move(curves), text.size(), hash.finish()};
}

}  // namespace libchar
