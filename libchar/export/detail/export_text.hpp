#pragma once
// Text that all exports share: what stands at the head of each file, numbers, comments.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/json.hpp"
#include "libchar/export/detail/consumer_rows.hpp"
#include "libchar/export/detail/export_figures.hpp"

namespace libchar {

/// Ten significant digits and always a decimal point ("2.0e-03" is a number to every YAML reader,
/// "2e-3" is text to some).
std::string export_number(double value);

/// "[1.0, 2.0, 3.0]".
std::string export_list(const std::array<double, 3>& values);

/// The value, or 0.
double value_or_zero(const ExportFigure& figure);

/// Text for one line of a comment of any language: ASCII, no "--" (XML), no backslash at the end (C++).
std::string comment_text(std::string_view text);

/// "sensorchar VERSION", "source: FILE sha256:…", channels, axes, inflation, `formula`: one line
/// each, without comment signs.
std::vector<std::string> head_lines(const SensorGroup& group, const ExportOptions& options, std::string_view formula);

/// The same as an object, for JSON files.
Json head_json(const SensorGroup& group, const ExportOptions& options, std::string_view formula);

/// Every line of `lines` behind `mark` ("# ", "// ", "% ").
std::string commented(const std::vector<std::string>& lines, std::string_view mark);

/// "UNIT; ORIGIN", or the unit alone.
std::string unit_and_origin(const std::string& unit, const std::string& origin);

/// "KEY: NUMBER  # UNIT; ORIGIN\n".
std::string yaml_line(std::string_view key, double value, std::string_view unit, const std::string& origin);

/// The four numbers of a target as YAML, each line behind `indent`.
std::string row_lines(std::string_view target, const ImuFigures& figures, std::string_view indent = "");

/// What has to be said of three axes: once if it is the same, else axis by axis.
std::string axis_origins(const std::array<std::string, 3>& origins);

/// The white noise of three axes by the target's row for it; what was replaced or left out is noted under its key.
struct RowOfAxes {
  std::string key;
  std::array<double, 3> values{};
  std::string comment;  ///< "UNIT; ORIGIN"
};
RowOfAxes white_of_axes(std::string_view target, const SensorTriad& triad, Absent absent, const ExportOptions& options,
                        std::vector<std::string>& notes, const RowTimes& times = {});

/// The bias of three axes as a first-order Gauss-Markov process each, in SI times a factor.
struct BiasOfAxes {
  std::array<const SensorModel*, 3> model{};  ///< whose numbers they are
  std::array<double, 3> to_unit{};            ///< from the model's unit, the factor included
  std::array<double, 3> steady_sd{}, correlation_s{};
  std::string origins;
};
/// Notes an axis without a process under its key.
BiasOfAxes bias_of_axes(const SensorTriad& triad, const ExportOptions& options, double factor, std::string_view key,
                        std::vector<std::string>& notes);

/// Puts down what was replaced or left out of `figure` under its key.
void note_figure(std::vector<std::string>& notes, std::string_view key, const ExportFigure& figure);

/// The topic that the options say, or that of the recording, as a YAML scalar that every reader takes for text. Throws
/// Error(usage) unless it is made of letters, digits, '_', '/', '~' and does not start with a digit.
std::string topic_scalar(const SensorGroup& group, const ExportOptions& options);

}  // namespace libchar
