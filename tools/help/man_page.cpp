#include "help/man_page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sensorchar {
namespace {

/// Text as roff reads it: what begins a command, what it escapes by, and hyphens that are to be typed.
std::string roff(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '"')
      out += "\\(dq";
    else if (c == '\'')
      out += "\\(aq";
    else if (c == '^')
      out += "\\(ha";
    else if (c == '~')
      out += "\\(ti";
    else
      out += c;
  }
  return out.starts_with('.') ? "\\&" + out : out;
}

std::string bold(std::string_view text) { return "\\fB" + roff(text) + "\\fP"; }

std::string italic(std::string_view text) { return "\\fI" + roff(text) + "\\fP"; }

// A list of words, "adev|oadev|…", may be broken behind its bars.
std::string breakable(std::string text) {
  for (std::size_t bar = text.find('|'); bar != std::string::npos; bar = text.find('|', bar + 3))
    text.insert(bar + 1, "\\:");
  return text;
}

std::string head(const ProgramUsage& program, const std::string& page, const std::string& what) {
  std::string title;
  for (const char c : page) title += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return fmt::format(".TH {} 1 {} \"{} {}\" \"User Commands\"\n.ad l\n.nh\n.SH NAME\n{} \\- {}\n", roff(title),
                     program.released, roff(program.name), roff(program.version), roff(page), roff(what));
}

std::string tagged(const std::string& tag, const std::string& text) { return ".TP\n" + tag + "\n" + text + "\n"; }

std::string option_entry(const OptionUsage& option) {
  std::string tag;
  for (const std::string& flag : option.flags) tag += (tag.empty() ? "" : ", ") + bold(flag);
  if (!option.name.empty()) tag += (tag.empty() ? "" : " ") + breakable(italic(option.name));
  std::string text = roff(option.help);
  if (option.required && !option.flags.empty()) text += " (required)";
  if (!option.only.empty()) text += roff(fmt::format(" (only {})", option.only));
  if (!option.excludes.empty()) text += roff(fmt::format(" (not with {})", fmt::join(option.excludes, ", ")));
  if (option.kind == ValueKind::words && option.name.find('|') == std::string::npos && !option.words.empty())
    text += roff(fmt::format(". Known: {}", fmt::join(option.words, ", ")));
  return tagged(tag, text);
}

std::string exit_status() {
  std::string text = ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : {std::pair{"0", "success"},
                                      {"1", "an error in the program"},
                                      {"2", "usage: an option or argument is wrong"},
                                      {"3", "an input is missing, malformed or over a limit"},
                                      {"4", "the numbers do not allow a result"},
                                      {"5", "an output cannot be written"},
                                      {"6", "a requested check failed"},
                                      {"130, 143", "stopped by a signal"}})
    text += tagged(bold(code), meaning);
  return text;
}

std::string environment() {
  return ".SH ENVIRONMENT\n" + tagged(bold("NO_COLOR"), "where it is set and not empty, nothing is coloured") +
         tagged(bold("COLUMNS"), "width of tables and help, in place of the terminal\\(aqs") +
         tagged(bold("TERM"), roff("\"dumb\": no progress and no colour"));
}

std::string paragraph(const std::string& text) { return ".PP\n" + text + "\n"; }

}  // namespace

std::string program_man_page(const ProgramUsage& program) {
  std::string page = head(program, program.name, "noise, models and fusion of sensors from recordings");
  page += ".SH SYNOPSIS\n" + bold(program.name) + " " + italic("VERB") + " [" + italic("OPTION") + "]...\n";
  page += ".br\n" + bold(program.name + " help") + " [" + italic("VERB") + "]\n";
  page += ".SH DESCRIPTION\n" + roff(program.what) + "\n";
  page += paragraph(
      "Results go to standard output, progress and messages to standard error. An error is one sentence with a code, "
      "its place, and what to do.");
  page += ".SH VERBS\n";
  for (const VerbUsage& verb : program.verbs)
    page += tagged("\\fB" + roff(typed(verb.name)) + "\\fP",
                   roff(verb.what) + "; see " + bold(program.name + "-" + verb.name) + "(1)");
  page += ".SH OPTIONS\n";
  for (const OptionUsage& option : program.options) page += option_entry(option);
  page += exit_status() + environment();
  page += ".SH FILES\n" +
          tagged(italic("/usr/share/doc/sensorchar"), "pages on formats, models, scenes, JSON, errors and the theory");
  page += ".SH SEE ALSO\n";
  std::string list;
  for (std::size_t k = 0; k < program.verbs.size(); ++k)
    list += fmt::format(".BR {}\\-{} (1){}\n", roff(program.name), roff(program.verbs[k].name),
                        k + 1 < program.verbs.size() ? "," : "");
  return page + list;
}

std::string verb_man_page(const ProgramUsage& program, const VerbUsage& verb) {
  std::string page = head(program, program.name + "-" + verb.name, verb.what);
  page += ".SH SYNOPSIS\n" + bold(program.name + " " + typed(verb.name)) + " [" + italic("OPTION") + "]...";
  for (const OptionUsage& argument : verb.arguments) {
    std::string word = italic(argument.name);
    if (argument.repeatable && !argument.name.ends_with("…")) word += "...";
    page += argument.required ? " " + word : " [" + word + "]";
  }
  page += "\n.SH DESCRIPTION\n" + roff(verb.what) + ".\n";
  if (!verb.arguments.empty()) page += ".SH ARGUMENTS\n";
  for (const OptionUsage& argument : verb.arguments) page += option_entry(argument);
  page += ".SH OPTIONS\n";
  for (const std::string& group : groups_of(verb)) {
    if (!group.empty()) page += ".SS " + roff(group) + "\n";
    for (const OptionUsage& option : verb.options)
      if (option.group == group) page += option_entry(option);
  }
  if (!verb.examples.empty()) page += ".SH EXAMPLES\n";
  for (const Example& example : verb.examples)
    page += paragraph(roff(example.what) + ":") + ".PP\n.RS\n.nf\n" + roff(example.command) + "\n.fi\n.RE\n";
  page += exit_status();
  return page + ".SH SEE ALSO\n.BR " + roff(program.name) + " (1)\n";
}

}  // namespace sensorchar
