#include "help/help_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/core/text/text_table.hpp"

namespace sensorchar {
namespace {

constexpr std::size_t kNarrowest = 40;

/// What stands left, and what is said of it.
struct HelpRow {
  std::string left, right;
};

/// A long list of words, "--type adev|oadev|…", goes on in the next line behind one of its bars.
std::string broken_at_bars(std::string_view left, std::size_t width) {
  constexpr std::string_view kMargin = "      ";
  std::string text;
  std::size_t used = 2;
  while (!left.empty()) {
    const std::size_t bar = left.find('|');
    const std::string_view piece = left.substr(0, bar == std::string_view::npos ? bar : bar + 1);
    const std::size_t places = libchar::width_of(piece);
    if (used + places > width && used > kMargin.size()) {
      text += fmt::format("\n{}", kMargin);
      used = kMargin.size();
    }
    text += piece;
    used += places;
    left.remove_prefix(piece.size());
  }
  return text;
}

/// The left column is as wide as its words, up to a third of the page: what is wider stands on a line of its own.
std::string help_rows(const std::vector<HelpRow>& rows, std::size_t width) {
  std::size_t column = 0;
  for (const HelpRow& row : rows) {
    const std::size_t places = libchar::width_of(row.left);
    if (places <= width / 3) column = std::max(column, places);
  }
  const std::string margin(column + 4, ' ');
  std::string text;
  for (const HelpRow& row : rows) {
    const std::size_t places = libchar::width_of(row.left);
    text += "  " + broken_at_bars(row.left, width);
    if (row.right.empty()) {
      text += "\n";
      continue;
    }
    text += places <= column ? std::string(column - places + 2, ' ') : "\n" + margin;
    text += libchar::wrapped(row.right, width, margin).substr(margin.size()) + "\n";
  }
  return text;
}

std::string option_text(const OptionUsage& option) {
  std::string text = option.help;
  if (option.required && !option.flags.empty()) text += " (required)";
  if (!option.only.empty()) text += fmt::format(" (only {})", option.only);
  if (!option.excludes.empty()) text += fmt::format(" (not with {})", fmt::join(option.excludes, ", "));
  return text;
}

std::string examples_text(const std::vector<Example>& examples, std::size_t width) {
  std::string text;
  for (const Example& example : examples)
    text += libchar::wrapped(example.what + ":", width, "  ") + "\n    " + example.command + "\n";
  return text;
}

}  // namespace

std::string program_help(const ProgramUsage& program, std::size_t width) {
  width = std::max(width, kNarrowest);
  std::string text = libchar::wrapped(program.what, width) + "\n\n";
  text += fmt::format("Usage: {} VERB [OPTION…] …\n\nVerbs:\n", program.name);
  std::vector<HelpRow> rows;
  for (const VerbUsage& verb : program.verbs) rows.push_back({typed(verb.name), verb.what});
  rows.push_back({"help VERB", "Show what a verb does, its options with units and defaults, examples"});
  text += help_rows(rows, width) + "\nOptions:\n";
  rows.clear();
  for (const OptionUsage& option : program.options) rows.push_back({flags_and_value(option), option_text(option)});
  return text + help_rows(rows, width) + "\n" + program.footer + "\n";
}

std::string group_help(const ProgramUsage& program, const std::string& first, std::size_t width) {
  std::vector<HelpRow> rows;
  for (const VerbUsage& verb : program.verbs)
    if (verb.name.starts_with(first + "-")) rows.push_back({typed(verb.name), verb.what});
  if (rows.empty()) return "";
  return fmt::format("Usage: {} {} VERB [OPTION…] …\n\nVerbs:\n", program.name, first) +
         help_rows(rows, std::max(width, kNarrowest)) +
         fmt::format("\nOptions and examples of a verb: {} help {}\n", program.name, rows[0].left);
}

std::string verb_help(const ProgramUsage& program, const VerbUsage& verb, std::size_t width) {
  width = std::max(width, kNarrowest);
  std::string text = libchar::wrapped(verb.what, width) + "\n\n";
  text += "Usage: " + synopsis(program, verb) + "\n";
  if (!verb.examples.empty()) text += "\nExamples:\n" + examples_text(verb.examples, width);
  std::vector<HelpRow> rows;
  for (const OptionUsage& argument : verb.arguments) rows.push_back({flags_and_value(argument), argument.help});
  if (!rows.empty()) text += "\nArguments:\n" + help_rows(rows, width);
  for (const std::string& group : groups_of(verb)) {
    rows.clear();
    for (const OptionUsage& option : verb.options)
      if (option.group == group) rows.push_back({flags_and_value(option), option_text(option)});
    if (!rows.empty()) text += "\n" + (group.empty() ? "Options" : group) + ":\n" + help_rows(rows, width);
  }
  return text;
}

}  // namespace sensorchar
