#include "libchar/fit/curve/curve_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "libchar/core/not_known.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/units.hpp"
#include "libchar/log/text_table.hpp"
#include "libchar/spectrum/spectrum_words.hpp"

namespace libchar {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{64} << 20U;

// "Tau [s]" and "tau" are the same name.
std::string bare_name(std::string name) {
  name.resize(std::min({name.find('['), name.find('('), name.size()}));
  while (!name.empty() && name.back() == ' ') name.pop_back();
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return name;
}

std::optional<std::size_t> find(const std::vector<TextCell>& header, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names)
    for (std::size_t c = 0; c < header.size(); ++c)
      if (bare_name(header[c].text) == name) return c;
  return std::nullopt;
}

// "adev [deg/s]", "psd[(deg/s)²/Hz]"; "" where a name has no unit behind it.
std::string unit_behind(const std::string& name) {
  const std::size_t open = name.find_first_of("[(");
  if (open == std::string::npos || !(name.ends_with(']') || name.ends_with(')'))) return "";
  return name.substr(open + 1, name.size() - open - 2);
}

struct Columns {
  std::optional<std::size_t> x, root, power, channel, unit, kind, dof, low, high, relative, absolute, low95, high95,
      model, findings;
  struct Units {
    double abscissa = 1;   // in s or Hz
    std::string value;     // behind its name
    bool percent = false;  // the relative error is
  } units;
};

Columns columns_of(const std::vector<TextCell>& header, bool is_allan) {
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
  c.low95 = find(header, {"low95"});
  c.high95 = find(header, {"high95"});
  c.model = find(header, {"model"});
  c.findings = find(header, {"findings"});
  c.relative = find(header, {"rel_err", "relative_error", "rel_error", "relative error", "relative_sd", "rel_sd",
                             "relative_uncertainty", "rel_unc"});
  if (c.x) c.units.abscissa = detail::abscissa_factor(unit_behind(header[*c.x].text), is_allan);
  if (c.root || c.power) c.units.value = unit_behind(header[c.root ? *c.root : *c.power].text);
  c.units.percent = c.relative && header[*c.relative].text.find('%') != std::string::npos;
  c.absolute = find(header, {"error", "err", "sd", "std", "stderr", "standard_error", "standard error", "uncertainty",
                             "deviation_sd", "dev_err"});
  return c;
}

// One row into its curve; the place is of the cell that does not fit.
class Reader {
 public:
  Reader(std::string file, const std::vector<TextCell>& header, char decimal, bool is_allan)
      : file_(std::move(file)),
        columns_(columns_of(header, is_allan)),
        width_(header.size()),
        decimal_(decimal),
        is_allan_(is_allan) {}

  bool has_curve() const { return columns_.x && (columns_.root || columns_.power); }

  void require_width(const TextRow& row, std::size_t width) const {
    if (row.cells.size() != width)
      throw input_error("E0304", fmt::format("{}:{}:1", file_, row.line))
          .says("{} fields, {} expected", row.cells.size(), width)
          .hint("each row has a value for each name of the header");
  }

  void take(const TextRow& row) {
    require_width(row, width_);
    const auto text = [&](const std::optional<std::size_t>& column) { return column ? row.cells[*column].text : ""; };
    const std::string kind = text(columns_.kind);
    if (columns_.kind && is_allan_ != (kind.find("dev") != std::string::npos || kind == "allan")) return;
    const std::string& unit = columns_.unit ? row.cells[*columns_.unit].text : columns_.units.value;
    NamedCurve& target = curve_of(columns_.channel ? text(columns_.channel) : "curve", unit, kind);
    if (columns_.findings && target.curve.x.empty())
      target.findings = detail::findings_in_cell(row.cells[*columns_.findings].text);
    const bool by_root = columns_.root.has_value();
    const double x = columns_.units.abscissa * number(row, *columns_.x),
                 y = number(row, by_root ? *columns_.root : *columns_.power);
    if (x == 0 && !is_allan_) ++zeros_;
    if (x < 0 && !is_allan_) target.curve.sides = Sides::two;
    if (x <= 0) return;  // the spectrum at zero frequency says nothing about noise
    target.curve.x.push_back(x);
    target.curve.y.push_back(y);
    if (const auto sd = relative_sd(row, y, target.curve.root)) target.curve.relative_sd.push_back(*sd);
    keep(target.low68, row, columns_.low);
    keep(target.high68, row, columns_.high);
    keep(target.low95, row, columns_.low95);
    keep(target.high95, row, columns_.high95);
    keep(target.model, row, columns_.model);
  }

  std::vector<NamedCurve> finish() {
    for (NamedCurve& named : curves_)
      if (named.curve.relative_sd.size() != named.curve.x.size()) named.curve.relative_sd.clear();
    return std::move(curves_);
  }

  std::uint64_t zeros() const { return zeros_; }

 private:
  double number(const TextRow& row, std::size_t c) const {
    const TextCell& cell = row.cells[c];
    if (const auto value = number_in(cell, decimal_)) return *value;
    throw input_error("E0311", fmt::format("{}:{}:{}", file_, row.line, cell.column))
        .says("a number was expected")
        .got(cell.text);
  }

  // Of the deviation (root), to first order half of the relative sd of its square, which is sqrt(2 / edf) for
  // chi-square.
  std::optional<double> relative_sd(const TextRow& row, double y, bool root) const {
    const auto cell = [&](const std::optional<std::size_t>& column) {
      return column ? number_in(row.cells[*column], decimal_) : std::nullopt;
    };
    if (const auto dof = cell(columns_.dof); dof && *dof > 0) return 1 / std::sqrt(2 * *dof);
    const double of_root = root ? 1 : 0.5;
    const auto low = cell(columns_.low), high = cell(columns_.high);
    if (low && high && y > 0 && *high > *low) return of_root * (*high - *low) / (2 * y);
    if (const auto sd = cell(columns_.relative); sd && *sd > 0)
      return of_root * *sd * (columns_.units.percent ? 0.01 : 1);
    if (const auto sd = cell(columns_.absolute); sd && *sd > 0 && y > 0) return of_root * *sd / y;
    return std::nullopt;
  }

  void keep(std::vector<double>& values, const TextRow& row, const std::optional<std::size_t>& column) const {
    if (column) values.push_back(number_in(row.cells[*column], decimal_).value_or(kNone));
  }

  NamedCurve& curve_of(const std::string& name, const std::string& unit, const std::string& kind) {
    const auto found = std::find_if(curves_.begin(), curves_.end(),
                                    [&](const NamedCurve& c) { return c.name == name && c.kind == kind; });
    if (found != curves_.end()) return *found;
    NamedCurve& added = curves_.emplace_back();
    added.name = name;
    const detail::SpectrumValues values = detail::values_of_unit(unit);
    added.unit = is_allan_ && columns_.root ? unit : values.unit;
    added.curve.is_allan = is_allan_;
    added.curve.root = columns_.root || (!is_allan_ && values.scaling == Scaling::lsd);
    if (const auto known = detail::spectrum_kind(kind)) added.curve.sides = known->sides;
    added.kind = kind;
    added.value_unit = unit;
    return curves_.back();
  }

  std::string file_;
  Columns columns_;
  std::size_t width_;
  char decimal_;
  bool is_allan_;
  std::vector<NamedCurve> curves_;
  std::uint64_t zeros_ = 0;
};

/// Spectra as psd prints them: frequency_hz, a column NAME[UNIT] for each channel, then perhaps `findings`.
struct Wide {
  std::vector<TextCell> names, units;
  bool with_findings = false;
};

Wide wide_of(const std::vector<TextCell>& header) {
  Wide out;
  if (header.size() < 2 || header[0].text != "frequency_hz") return out;
  out.with_findings = header.back().text == "findings";
  for (std::size_t c = 1; c + (out.with_findings ? 1 : 0) < header.size(); ++c) {
    const std::string& cell = header[c].text;
    const std::size_t open = cell.rfind('[');
    if (open == std::string::npos || !cell.ends_with(']')) return {};
    out.names.push_back({cell.substr(0, open)});
    out.units.push_back({cell.substr(open + 1, cell.size() - open - 2)});
  }
  return out;
}

/// The header of rows that hold one value each.
std::vector<TextCell> narrow_header() {
  return {{"frequency_hz"}, {"value"}, {"channel"}, {"unit"}, {"curve"}, {"findings"}};
}

/// What the first row says of each channel: "motion:bad|event:caution".
std::vector<TextCell> findings_in(const Wide& wide, const TextTable& table) {
  std::vector<TextCell> out(wide.names.size());
  if (!wide.with_findings || table.rows.empty()) return out;
  std::size_t c = 0;
  for (const char one : table.rows[0].cells.back().text)
    if (one == '|')
      c = std::min(c + 1, out.size() - 1);
    else
      out[c].text += one;
  return out;
}

/// Each value as a row of its own; a channel with another rate has none at some frequencies.
void take_wide(Reader& reader, const Wide& wide, const TextTable& table) {
  const std::vector<TextCell> known = findings_in(wide, table);
  const bool two = std::any_of(table.rows.begin(), table.rows.end(), [&](const TextRow& row) {
    return !row.cells.empty() && number_in(row.cells[0], table.decimal).value_or(0) < 0;
  });
  for (const TextRow& row : table.rows) {
    reader.require_width(row, table.header.cells.size());
    for (std::size_t c = 0; c < wide.names.size(); ++c) {
      if (row.cells[c + 1].text.empty()) continue;
      const Scaling scaling = detail::values_of_unit(wide.units[c].text).scaling;
      const std::string kind = detail::spectrum_kind_word({scaling, two ? Sides::two : Sides::one});
      reader.take({row.line, {row.cells[0], row.cells[c + 1], wide.names[c], wide.units[c], {kind}, known[c]}});
    }
  }
}

}  // namespace

double detail::abscissa_factor(const std::string& unit, bool is_allan) {
  const auto known = find_unit(unit);
  return known && known->quantity == (is_allan ? Quantity::time : Quantity::frequency) ? known->to_si : 1;
}

std::optional<CurveTable> read_curve_table(const std::string& path, bool is_allan) {
  const auto table = read_text_table(path, kMaxBytes);
  if (!table)
    throw input_error("E0801", path)
        .says("a table of curves of more than {} bytes", kMaxBytes)
        .hint("is this a log? then leave `curve` out");
  const Wide wide = is_allan ? Wide{} : wide_of(table->header.cells);
  Reader reader(path, wide.names.empty() ? table->header.cells : narrow_header(), table->decimal, is_allan);
  if (!reader.has_curve()) return std::nullopt;
  if (!wide.names.empty())
    take_wide(reader, wide, *table);
  else
    for (const TextRow& row : table->rows) reader.take(row);
  auto curves = reader.finish();
  if (curves.empty())
    throw input_error("E0802", path)
        .says(is_allan ? "the table holds no Allan curve" : "the table holds no spectrum")
        .hint(is_allan ? "`curve` psd?" : "`curve` allan?");
  return CurveTable{std::move(curves), reader.zeros(), table->bytes, table->sha256};
}

std::string curve_in_header(const std::string& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return "";
  TextRow first;
  try {
    first = detail::header_of_text_table(path);
  } catch (const Error&) {
    return "";
  }
  const std::vector<TextCell>& header = first.cells;
  if (find(header, {"curve"}) && find(header, {"x"}) && find(header, {"value"})) return "allan or psd";
  if (find(header, {"tau_s", "tau", "averaging_time"})) {
    const Columns c = columns_of(header, true);
    return c.root || c.power ? "allan" : "";
  }
  if (!find(header, {"frequency_hz", "frequency", "freq"})) return "";
  const Columns c = columns_of(header, false);
  return c.root || c.power || !wide_of(header).names.empty() ? "psd" : "";
}

}  // namespace libchar
