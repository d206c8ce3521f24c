// plot FILE…: a figure of reports, curves and models as SVG, PDF, PNG, as a script for gnuplot, or as its numbers.

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "analysis_options.hpp"
#include "libchar/characterize/compare/characterization_comparison.hpp"
#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/file/output_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/make_figure.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using namespace libchar;

struct PlotVerb {
  std::vector<std::string> files;
  std::string output, gnuplot, csv, width, height, x_range, y_range, format;
  FigureOptions figure;
  DrawingOptions drawing;
  bool force = false, list = false;
  AnalysisOptions analysis;
};

/// "85mm", "3.3in", "12cm", "240pt", or a column of a journal.
double length_mm(const std::string& flag, const std::string& text) {
  if (text == "one-column") return kOneColumnMm;
  if (text == "two-columns") return kTwoColumnsMm;
  constexpr std::pair<std::string_view, double> kUnits[] = {{"mm", 1}, {"cm", 10}, {"in", 25.4}, {"pt", 25.4 / 72}};
  for (const auto& [unit, factor] : kUnits) {
    if (!text.ends_with(unit)) continue;
    const auto value = parse_double(text.substr(0, text.size() - unit.size()));
    if (value && *value > 0) return *value * factor;
  }
  throw usage_error("E0981", flag)
      .says("a length was expected: a number above zero with mm, cm, in or pt, or one-column, two-columns")
      .got(text)
      .hint("such as 85mm");
}

std::optional<Interval> range_of(const std::string& flag, const std::string& text) {
  if (text.empty()) return std::nullopt;
  return libchar::parse_range(text, libchar::RangeOf::number, flag);
}

FigureFormat format_of(const PlotVerb& verb) {
  if (!verb.format.empty()) return *find_enum<FigureFormat>(verb.format);
  if (verb.output == "-") return FigureFormat::svg;
  const std::size_t dot = verb.output.rfind('.');
  const std::string ending = dot == std::string::npos ? "" : ascii_lower(verb.output.substr(dot + 1));
  if (const auto known = find_enum<FigureFormat>(ending)) return *known;
  throw usage_error("E0979", "--output")
      .says("the name ends neither in .svg nor in .pdf or .png")
      .got(verb.output)
      .hint("or say --format svg");
}

void print_kinds() {
  std::string text;
  for (const FigureKind& kind : figure_kinds())
    text += fmt::format("{:<12} {}{}\n", kind.word, kind.title, kind.of_replay ? " (replay)" : "");
  print(text);
}

void refuse_nothing_asked(const PlotVerb& verb) {
  if (verb.files.empty())
    throw usage_error("E0205", "plot").says("FILE is required").hint("sensorchar plot --list names the figures");
  if (verb.output.empty() && verb.gnuplot.empty() && verb.csv.empty())
    throw usage_error("E0205", "plot")
        .says("-o, --gnuplot or --csv is required: where the figure goes")
        .hint("such as -o figure.pdf; - is standard output");
  const auto dashes = (verb.output == "-" ? 1 : 0) + (verb.gnuplot == "-" ? 1 : 0) + (verb.csv == "-" ? 1 : 0);
  if (dashes > 1) throw usage_error("E0205", "plot").says("only one output can go to standard output");
}

/// Those of a folder get their names together.
void write_together(const std::vector<OutputFile>& outputs, bool overwrite) {
  std::vector<WholeFile> files;
  for (const OutputFile& output : outputs)
    if (output.path != "-") files.emplace_back(output.path, overwrite).write(output.text);
  std::vector<WholeFile*> all;
  for (WholeFile& file : files) all.push_back(&file);
  if (!all.empty()) commit_together(all);
}

void deliver(const std::vector<OutputFile>& made, bool force) {
  write_together(made, force);
  for (const OutputFile& one : made)
    if (one.path == "-") print(one.text);
}

/// Those that are given.
std::vector<std::string> named(std::vector<std::string> paths) {
  std::erase(paths, "");
  return paths;
}

/// A recording is characterized on the way.
FigureSource source_of(Session& session, const PlotVerb& verb, const std::string& file) {
  if (!detail::is_recording(file)) return read_figure_source(file);
  FigureSource out = parse_figure_source(report_of_recording(session, file, finish(verb.analysis)).text, file);
  out.name = detail::document_name(file);
  return out;
}

/// The names of channels that are meant, also those by which `channels` means what they measure.
std::vector<std::string> meant_channels(const FigureSource& source, const std::vector<std::string>& channels) {
  std::vector<std::string> out = channels;
  for (const SourceCurve& curve : source.curves)
    for (const std::string& one : channels)
      if (matches(one, detail::usual_channel_name(curve.channel, curve.unit))) out.push_back(curve.channel);
  return out;
}

void run_plot(Session& session, PlotVerb& verb) {
  if (verb.list) return print_kinds();
  refuse_nothing_asked(verb);
  if (!verb.width.empty()) verb.drawing.width_mm = length_mm("--width", verb.width);
  if (!verb.height.empty()) verb.drawing.height_mm = length_mm("--height", verb.height);
  verb.figure.x_range = range_of("--x-range", verb.x_range);
  verb.figure.y_range = range_of("--y-range", verb.y_range);
  const FigureFormat format = verb.output.empty() ? FigureFormat::svg : format_of(verb);
  for (const std::string* path : {&verb.output, &verb.gnuplot, &verb.csv})
    if (!path->empty() && *path != "-") foresee_output(*path, verb.files, verb.force);
  refuse_one_name(named({verb.output, verb.gnuplot, verb.csv}));
  std::vector<FigureSource> sources;
  for (const std::string& file : verb.files) sources.push_back(source_of(session, verb, file));
  const Chart figure = make_figure(sources, verb.figure);
  std::vector<OutputFile> made;
  Findings warnings;
  if (!verb.output.empty()) made.push_back({verb.output, draw_figure(figure, format, verb.drawing, warnings)});
  if (!verb.gnuplot.empty()) made.push_back({verb.gnuplot, figure_gnuplot(figure, verb.drawing)});
  if (!verb.csv.empty()) made.push_back({verb.csv, figure_csv(figure)});
  deliver(made, verb.force);
  for (const FigureSource& source : sources)
    report_findings(session, source.name, source.findings, meant_channels(source, verb.figure.channels));
  session.terminal.warn(warnings, verb.output);
}

void add_looks(VerbOptions& options, PlotVerb& verb) {
  options
      .add_text("--width", verb.width,
                "one-column (85 mm), two-columns (178 mm), or a length such as 88mm, 7in (default: one-column)")
      .value_name("LENGTH");
  options.add_text("--height", verb.height, "a length (default: to suit width and legend)").value_name("LENGTH");
  options.add_enum("--legend", verb.drawing.legend,
                   "place of the names (default: auto, a corner without curves, else below)");
  options.add_text("--title", verb.figure.title, "title above the plot (default: none)");
  options.add_flag("--grey", verb.drawing.grey, "greys in place of colours");
  options.add_number("--dpi", verb.drawing.dpi, "resolution of a PNG (default: 300)", 10, 4800);
  options.add_text("--x-range", verb.x_range, "ends of the horizontal axis").value_name("LOW..HIGH");
  options.add_text("--y-range", verb.y_range, "ends of the vertical axis").value_name("LOW..HIGH");
}

/// The table has numbers alone, the script all that belongs to the figure but its legend and its pixels.
void add_only(VerbOptions& options, const PlotVerb& verb) {
  const auto drawn = [&verb] { return !verb.output.empty(); };
  const auto shown = [&verb] { return !verb.output.empty() || !verb.gnuplot.empty(); };
  options.only("with -o", drawn, {"--format", "--legend", "--grey"});
  options.only("with -o or --gnuplot", shown, {"--width", "--height", "--title"});
  options.only("for a PNG", [&verb] { return !verb.output.empty() && format_of(verb) == FigureFormat::png; },
               {"--dpi"});
}

std::function<void()> plot_options(VerbOptions& options, Session& session) {
  const auto verb = std::make_shared<PlotVerb>();
  options.add_texts("FILE", verb->files,
                    "recordings, report.json of characterize or replay (or its folder), output of allan or psd, "
                    "curves.csv, sensor models; several are drawn over each other");
  options.add_text("-o,--output", verb->output, "the figure: .svg, .pdf or .png (- is standard output)")
      .value_name("FILE");
  options.add_choice("--kind", verb->figure.kind, figure_words(),
                     "figure to draw (default: allan of a characterization, front of a replay)");
  options.add_flag("--list", verb->list, "list the figures").alone();
  options
      .add_texts("-c,--channel", verb->figure.channels,
                 "channels (of a replay: methods or sensors) by name or pattern such as 'gyro*'; gyro_x fits any "
                 "channel that measures it (default: all)")
      .separated_by_commas()
      .once_each();
  options.add_text(
      "--algorithm", verb->figure.algorithm,
      "of a replay: method whose weights, variances and findings are drawn (default: the best that has them)");
  options.add_text("--input", verb->figure.input,
                   "of a replay with several true inputs: the one to draw (default: the first)");
  options.add_texts("--label", verb->figure.labels, "name of each FILE in the legend").separated_by_commas();
  add_looks(options, *verb);
  options.add_text("--gnuplot", verb->gnuplot, "the numbers in a script for gnuplot").value_name("FILE");
  options.add_text("--csv", verb->csv, "the numbers that are drawn, as a table").value_name("FILE");
  options.add_choice("--format", verb->format, words_of<FigureFormat>(), "format of -o (default: by its name)");
  options.add_flag("--force", verb->force, "overwrite the output files");
  add_recording_options(options, session, verb->analysis, verb->files, false);
  add_only(options, *verb);
  return [&session, verb] { run_plot(session, *verb); };
}

}  // namespace

VerbEntry verb_plot() {
  return {9,
          "plot",
          "Draw a figure of reports, curves and models: SVG, PDF, PNG, gnuplot, CSV",
          plot_options,
          {{"the Allan deviation of one channel for a paper", "sensorchar plot report -c gyro_z -o gyro_z.pdf"},
           {"which method of a replay to use", "sensorchar plot array-replay --kind ranking -o ranking.svg"}}};
}

}  // namespace sensorchar
