// The only file that includes the parser.
#include "command_line.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <set>
#include <sstream>

#include "colour.hpp"
#include "help/usage.hpp"
#include "libchar/core/process/version.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/quantity_text.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"
#include "verb.hpp"

namespace sensorchar {
namespace {

using libchar::Error;
using libchar::ErrorKind;

// The chosen verb, else the program itself.
const CLI::App& chosen(const CLI::App& app) {
  const auto verbs = app.get_subcommands();
  return verbs.empty() ? app : *verbs.front();
}

std::string full_name(const CLI::App& app) {
  const CLI::App& verb = chosen(app);
  return &verb == &app ? app.get_name() : app.get_name() + " " + typed(verb.get_name());
}

std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

// CLI11 only lists what it could not place; the nearest name is what helps.
std::string say_unknown(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true);
  const std::string word = rest.empty() ? "" : rest.front();
  const bool option = word.starts_with('-');
  std::string line = option ? fmt::format("unknown option \"{}\"", libchar::printable(word, 40))
                            : fmt::format("\"{}\" is one argument too many", libchar::printable(word, 40));
  if (option) {
    if (const auto near = libchar::nearest(word.substr(0, word.find('=')), option_names(chosen(app))))
      line += fmt::format("; did you mean {}?", *near);
  }
  return line;
}

// A second log where one is read: the files of an array are a recording together.
std::string hint_for_extra(const CLI::App& app) {
  const std::vector<std::string> rest = app.remaining(true), known = option_names(chosen(app));
  struct stat status {};
  if (!rest.empty() && ::stat(rest.front().c_str(), &status) == 0 &&
      std::count(known.begin(), known.end(), "--topic") > 0)
    return "logs of one array go into a folder of their own, which then is the recording (--topic '*')";
  return full_name(app) + " --help";
}

// A file in the place of the verb is looked at.
std::vector<std::string> with_verb(const CLI::App& app, const std::vector<std::string>& command) {
  std::vector<std::string> full = command;
  if (command.size() < 2) return full;
  const auto verbs = app.get_subcommands([](const CLI::App*) { return true; });
  const bool verb =
      std::any_of(verbs.begin(), verbs.end(), [&](const CLI::App* sub) { return sub->get_name() == command[1]; });
  const bool inspects =
      std::any_of(verbs.begin(), verbs.end(), [](const CLI::App* sub) { return sub->get_name() == "inspect"; });
  struct stat status {};
  const bool log = command[1] == "-" || (!command[1].starts_with('-') && ::stat(command[1].c_str(), &status) == 0 &&
                                         !S_ISDIR(status.st_mode));
  if (!verb && log && inspects) full.insert(full.begin() + 1, "inspect");
  return full;
}

// A word in the place of the verb that is none: its nearest verb, or what to do with a file.
void check_verb(const CLI::App& app, const std::vector<std::string>& command) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  if (command.size() < 2)
    throw libchar::usage_error("E0203", app.get_name())
        .says("which verb? one of {}", fmt::join(verbs, ", "))
        .hint("{} --help", app.get_name());
  if (command[1].starts_with('-')) {
    static const std::vector<std::string> kOwn = {"--help", "--version", "-h"};
    if (std::find(kOwn.begin(), kOwn.end(), command[1]) != kOwn.end()) return;
    const auto near = libchar::nearest(command[1], kOwn);
    throw libchar::usage_error("E0204", app.get_name())
        .says("unknown option before the verb")
        .got(command[1])
        .hint(libchar::did_you_mean(near, "options follow the verb"));
  }
  if (std::find(verbs.begin(), verbs.end(), command[1]) != verbs.end()) return;
  struct stat status {};
  std::string hint = fmt::format("the verbs are {}", fmt::join(verbs, ", "));
  if (const auto near = libchar::nearest(command[1], verbs))
    hint = libchar::did_you_mean(near);
  else if (::stat(command[1].c_str(), &status) == 0)
    hint = fmt::format("to see what is in this file: {} inspect FILE", app.get_name());
  else if (command[1].find_first_of("./") != std::string::npos)
    throw libchar::usage_error("E0203", app.get_name())
        .says("no verb and no file has this name")
        .got(command[1])
        .hint(hint);
  throw libchar::usage_error("E0203", app.get_name()).says("unknown verb").got(command[1]).hint(hint);
}

/// What a value's name says of it: "SCENE|LOG" is a file, "DIR" a folder, "SENSOR=FILE" neither.
ValueKind kind_of_name(const std::string& name) {
  static constexpr std::array<std::string_view, 9> kFiles = {"LOG", "FILE",   "MODEL", "SCENE", "CURVE",
                                                             "RUN", "REPORT", "A",     "B"};
  if (name.find('=') != std::string::npos) return ValueKind::text;
  ValueKind kind = ValueKind::text;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t end = std::min(name.find('|', at), name.size());
    const std::string_view word = std::string_view(name).substr(at, end - at);
    const std::string_view letters = word.substr(0, word.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZ"));
    if (std::find(kFiles.begin(), kFiles.end(), letters) != kFiles.end()) return ValueKind::file;
    if (letters == "DIR" || letters == "FOLDER") kind = ValueKind::folder;
    at = end + 1;
  }
  return kind;
}

OptionUsage usage_of_option(const CLI::Option& option, const OptionNotes& notes) {
  OptionUsage usage;
  for (const std::string& flag : option.get_snames()) usage.flags.push_back("-" + flag);
  for (const std::string& flag : option.get_lnames()) usage.flags.push_back("--" + flag);
  const bool value = option.get_expected_max() > 0;
  if (value) {
    usage.name = option.get_type_name();
    if (usage.flags.empty() && usage.name == "TEXT") usage.name = option.get_name(true);
    usage.kind = kind_of_name(usage.name);
  }
  if (const auto note = notes.find(&option); note != notes.end()) {
    usage.words = note->second.words;
    if (!usage.words.empty()) usage.kind = ValueKind::words;
    usage.only = note->second.only;
  }
  usage.comma_list = option.get_delimiter() == ',';
  usage.required = option.get_required();
  usage.repeatable =
      option.get_expected_max() > 1 || option.get_multi_option_policy() == CLI::MultiOptionPolicy::TakeAll;
  usage.group = option.get_group() == "Options" ? "" : option.get_group();
  usage.help = option.get_description();
  for (const CLI::Option* other : option.get_excludes()) usage.excludes.push_back("--" + other->get_lnames().front());
  return usage;
}

// "--output" for "-o", as messages name it.
std::string flag_of(const CLI::Option& option) {
  if (!option.get_lnames().empty()) return "--" + option.get_lnames().front();
  return option.get_snames().empty() ? option.get_name(true) : "-" + option.get_snames().front();
}

void refuse_twice(const CLI::Option& option) {
  std::set<std::string> named;
  for (const std::string& value : option.results())
    if (!named.insert(value.substr(0, value.rfind('='))).second)
      throw libchar::usage_error("E0205", flag_of(option))
          .says("named twice; only one of the two would count")
          .got(value);
}

bool says_how_to_print(const CLI::Option& option) {
  const std::string flag = flag_of(option);
  return flag == "--json" || flag == "--quiet" || flag == "--color";
}

void refuse_beside(const CLI::App& verb, const CLI::Option& alone) {
  for (const CLI::Option* other : verb.get_options())
    if (other != &alone && other->count() > 0 && !says_how_to_print(*other))
      throw libchar::usage_error("E0209", flag_of(*other))
          .says("has an effect only without " + flag_of(alone))
          .hint("leave one of the two out");
}

// An option that is accepted has an effect.
void refuse_without_effect(const CLI::App& verb, const OptionNotes& notes) {
  for (const CLI::Option* option : verb.get_options()) {
    const auto note = notes.find(option);
    if (option->count() == 0 || note == notes.end()) continue;
    if (note->second.once_each) refuse_twice(*option);
    if (note->second.alone) refuse_beside(verb, *option);
    if (!note->second.works || note->second.works()) continue;
    throw libchar::usage_error("E0209", flag_of(*option))
        .says("has an effect only " + note->second.only)
        .hint("leave it out");
  }
}

// A variable of the shell that is not set is no value: where a name, a folder or a limit belongs it would switch off
// what was asked for, and the parser would give "--limits=" the next word.
void refuse_empty_words(const CLI::App& app, const std::vector<std::string>& command) {
  for (std::size_t i = 1; i < command.size(); ++i) {
    const std::string& word = command[i];
    const std::string& before = command[i - 1];
    const bool cut = word.starts_with("--") && word.size() > 3 && word.find('=') == word.size() - 1;
    if (!word.empty() && !cut) continue;
    const bool of_option = !cut && i > 1 && before.starts_with('-') && before.size() > 1;
    if (const std::string& flag = cut ? word : before; flag == "-o" || flag.starts_with("--output"))
      throw libchar::output_error("E0502", "--output").says("an output file needs a name");
    throw libchar::usage_error("E0207", cut         ? word.substr(0, word.size() - 1)
                                        : of_option ? before
                                                    : app.get_name())
        .says("a value is expected, but it is empty")
        .hint("is a shell variable unset? leave the option out to use its default");
  }
}

void check_word(const std::string& text, const std::vector<std::string>& words) {
  if (std::find(words.begin(), words.end(), text) != words.end()) return;
  const auto near = libchar::nearest(text, words);
  throw libchar::usage_error("E0202")
      .says("expected one of {}", fmt::join(words, ", "))
      .got(text)
      .hint(libchar::did_you_mean(near));
}

}  // namespace

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::group(const std::string& heading) {
  option_->group(heading);
  return *this;
}

Option& Option::value_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::separated_by_commas() {
  option_->delimiter(',');
  // "a, b" is a and b
  option_->transform(CLI::Validator(
      [](std::string& text) {
        text = CLI::detail::trim_copy(text);
        return std::string();
      },
      "", ""));
  return *this;
}

Option& Option::one_value_each() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

Option& Option::known_words(std::vector<std::string> words) {
  (*notes_)[option_].words = std::move(words);
  return *this;
}

Option& Option::only(const std::string& where, std::function<bool()> works) {
  OptionNote& note = (*notes_)[option_];
  note.only = where;
  note.works = std::move(works);
  return *this;
}

Option& Option::alone() {
  (*notes_)[option_].alone = true;
  return *this;
}

Option& Option::writes() {
  (*notes_)[option_].writes = true;
  return *this;
}

Option& Option::once_each() {
  (*notes_)[option_].once_each = true;
  return *this;
}

void VerbOptions::only(const std::string& where, const std::function<bool()>& works,
                       const std::vector<std::string>& flags) {
  for (const std::string& flag : flags) added(app_->get_option(flag)).only(where, works);
}

Option VerbOptions::add_flag(const std::string& names, bool& value, const std::string& help) {
  return added(app_->add_flag(names, value, help));
}

Option VerbOptions::add_text(const std::string& names, std::string& value, const std::string& help) {
  return added(app_->add_option(names, value, help));
}

Option VerbOptions::add_texts(const std::string& names, std::vector<std::string>& values, const std::string& help) {
  return added(app_->add_option(names, values, help));
}

namespace {

// What `read` refuses is told of the option.
std::function<void(const std::string&)> named_reading(const std::string& names,
                                                      std::function<void(const std::string&)> read) {
  return [read = std::move(read), name = names.substr(names.rfind(',') + 1)](const std::string& text) {
    try {
      read(text);
    } catch (const Error& error) {
      libchar::Problem problem = error.problem();
      if (problem.where.empty()) problem.where = name;
      throw Error(problem);
    }
  };
}

}  // namespace

Option VerbOptions::add_parsed(const std::string& names, const std::string& value_name,
                               std::function<void(const std::string&)> read, const std::string& help) {
  CLI::Option* option = app_->add_option_function<std::string>(names, named_reading(names, std::move(read)), help);
  return added(option->type_name(value_name));
}

Option VerbOptions::add_parsed_each(const std::string& names, const std::string& value_name,
                                    std::function<void(const std::string&)> read, const std::string& help) {
  const auto each = [one = named_reading(names, std::move(read))](const std::vector<std::string>& texts) {
    for (const std::string& text : texts) one(text);
  };
  CLI::Option* option = app_->add_option_function<std::vector<std::string>>(names, each, help);
  return added(option->type_name(value_name)).separated_by_commas().one_value_each();
}

Option VerbOptions::add_number(const std::string& names, std::optional<double>& value, const std::string& help,
                               double lowest, double highest) {
  const auto read = [&value, lowest, highest](const std::string& text) {
    value = libchar::parse_number(text, lowest, highest);
  };
  return add_parsed(names, "NUMBER", read, help);
}

Option VerbOptions::add_number(const std::string& names, double& value, const std::string& help, double lowest,
                               double highest) {
  const auto read = [&value, lowest, highest](const std::string& text) {
    value = libchar::parse_number(text, lowest, highest);
  };
  return add_parsed(names, "NUMBER", read, help);
}

Option VerbOptions::add_count(const std::string& names, std::uint64_t& value, const std::string& help,
                              std::uint64_t lowest, std::uint64_t highest) {
  const auto read = [&value, lowest, highest](const std::string& text) {
    value = libchar::parse_count(text, lowest, highest);
  };
  return add_parsed(names, "N", read, help);
}

Option VerbOptions::add_duration(const std::string& names, std::optional<double>& seconds, const std::string& help) {
  const auto read = [&seconds](const std::string& text) { seconds = libchar::parse_duration_s(text, true); };
  return add_parsed(names, "TIME", read, help);
}

Option VerbOptions::add_instant(const std::string& names, std::optional<double>& seconds, const std::string& help) {
  const auto read = [&seconds](const std::string& text) { seconds = libchar::parse_duration_s(text); };
  return add_parsed(names, "TIME", read, help);
}

Option VerbOptions::add_rate(const std::string& names, std::optional<double>& hertz, const std::string& help) {
  const auto read = [&hertz](const std::string& text) { hertz = libchar::parse_rate_hz(text); };
  return add_parsed(names, "RATE", read, help);
}

Option VerbOptions::add_bytes(const std::string& names, std::uint64_t& bytes, const std::string& help) {
  const auto read = [&bytes](const std::string& text) { bytes = libchar::parse_bytes(text, 1024); };
  return add_parsed(names, "BYTES", read, help);
}

Option VerbOptions::add_document_output(std::string& path) {
  const auto read = [&path](const std::string& text) { path = text == "-" ? "" : text; };
  return add_parsed("-o,--output", "FILE", read, "output file (default: -, standard output)");
}

Option VerbOptions::add_choice(const std::string& names, std::string& value, std::vector<std::string> words,
                               const std::string& help) {
  return add_word(names, std::move(words), help, [&value](const std::string& word) { value = word; });
}

Option VerbOptions::add_choices(const std::string& names, std::vector<std::string>& values,
                                std::vector<std::string> words, const std::string& help) {
  const std::string value_name = fmt::format("{}", fmt::join(words, "|"));
  const auto read = [words, &values](const std::string& text) {
    values.clear();
    for (std::size_t from = 0; from <= text.size();) {
      const std::size_t comma = std::min(text.find(',', from), text.size());
      const std::string word = text.substr(from, comma - from);
      check_word(word, words);
      if (std::find(values.begin(), values.end(), word) != values.end())
        throw libchar::usage_error("E0205").says("a word is repeated in the list").got(word);
      values.push_back(word);
      from = comma + 1;
    }
  };
  return add_parsed(names, value_name, read, help).known_words(std::move(words));
}

Option VerbOptions::add_word(const std::string& names, std::vector<std::string> words, const std::string& help,
                             std::function<void(const std::string&)> use) {
  const std::string value_name = fmt::format("{}", fmt::join(words, "|"));
  const auto read = [words, use = std::move(use)](const std::string& text) {
    check_word(text, words);
    use(text);
  };
  return add_parsed(names, value_name, read, help).known_words(std::move(words));
}

std::vector<std::string> with_joined_verb(const std::vector<std::string>& command,
                                          const std::vector<std::string>& verbs) {
  const std::size_t at = command.size() > 2 && command[1] == "help" ? 2 : 1;
  if (command.size() <= at) return command;
  const std::string first = command[at] + "-";
  std::vector<std::string> seconds;
  for (const std::string& verb : verbs)
    if (verb.starts_with(first)) seconds.push_back(verb.substr(first.size()));
  const bool is_verb = std::find(verbs.begin(), verbs.end(), command[at]) != verbs.end();
  if (seconds.empty() || is_verb) return command;
  const std::string second = command.size() > at + 1 ? command[at + 1] : "";
  const bool help = second == "--help" || second == "-h" || second == "help";
  if (at == 1 && second == "help" && command.size() > 3)  // fleet help plan
    return with_joined_verb({command[0], "help", command[1], command[3]}, verbs);
  if (help || (at == 2 && second.empty())) return {command[0], "help", command[at]};
  if (std::find(seconds.begin(), seconds.end(), second) == seconds.end()) {
    std::optional<std::string> near = libchar::nearest(second, seconds);
    if (near) near = command[at] + " " + *near;
    throw libchar::usage_error("E0203", "sensorchar " + command[at])
        .says("which one? one of {}", fmt::join(seconds, ", "))
        .got(second)
        .hint(libchar::did_you_mean(near, "sensorchar help " + command[at]));
  }
  std::vector<std::string> joined = command;
  joined[at] = first + second;
  joined.erase(joined.begin() + static_cast<std::ptrdiff_t>(at) + 1);
  return joined;
}

CommandLine::CommandLine(const std::string& program, const std::string& what, const std::string& version,
                         const std::string& footer)
    : app_(std::make_unique<CLI::App>(what, program)) {
  app_->set_help_flag("-h,--help", "this page");
  app_->set_version_flag("--version", version, "version, build type, compiler and commit");
  app_->require_subcommand(1);
  app_->footer(footer);
}

CommandLine::~CommandLine() = default;

void CommandLine::add(const VerbEntry& entry, Session& session) {
  CLI::App* sub = app_->add_subcommand(entry.name, entry.what);
  sub->add_flag_callback(
      "-q,--quiet", [&session] { session.terminal.be_quiet(); },
      "nothing but errors on stderr: no progress, no warnings, no notes");
  examples_[entry.name] = entry.examples;
  VerbOptions options(*sub, notes_);
  options
      .add_parsed(
          "--color", "auto|always|never",
          [](const std::string& text) {
            const auto colour = libchar::find_enum<Colour>(text);
            if (!colour) throw libchar::usage_error("E0202").says("expected one of auto, always, never").got(text);
            use_colour(*colour);
          },
          "colour statuses and messages; auto: on a terminal, unless NO_COLOR is set (default: auto)")
      .known_words(libchar::words_of<Colour>());
  sub->final_callback([this, sub, run = entry.add_options(options, session)] {
    if (only_parses_) return;
    refuse_without_effect(*sub, notes_);
    run();
  });
}

VerbUsage CommandLine::usage_of(const CLI::App& verb) const {
  VerbUsage usage{verb.get_name(), verb.get_description(), {}, {}, examples_.at(verb.get_name())};
  for (const CLI::Option* option : verb.get_options()) {
    OptionUsage one = usage_of_option(*option, notes_);
    (one.flags.empty() ? usage.arguments : usage.options).push_back(std::move(one));
  }
  return usage;
}

ProgramUsage CommandLine::usage() const {
  ProgramUsage usage;
  usage.name = app_->get_name();
  usage.what = app_->get_description();
  usage.version = libchar::version();
  usage.footer = app_->get_footer();
  for (const CLI::Option* option : app_->get_options()) usage.options.push_back(usage_of_option(*option, notes_));
  for (const CLI::App* verb : app_->get_subcommands([](const CLI::App*) { return true; }))
    usage.verbs.push_back(usage_of(*verb));
  return usage;
}

void CommandLine::parse(const std::vector<std::string>& argv) {
  std::vector<std::string> verbs;
  for (const CLI::App* verb : app_->get_subcommands([](const CLI::App*) { return true; }))
    verbs.push_back(verb->get_name());
  const std::vector<std::string> command = with_verb(*app_, with_joined_verb(argv, verbs));
  check_verb(*app_, command);
  refuse_empty_words(*app_, command);
  std::vector<std::string> last_first(command.rbegin(), command.rend() - 1);
  app_->parse(last_first);
}

std::vector<ParsedWord> CommandLine::parsed(const std::vector<std::string>& argv) {
  only_parses_ = true;
  const auto answer = run(argv);
  only_parses_ = false;
  std::vector<ParsedWord> out;
  if (answer) return out;  // --help
  for (const CLI::Option* option : chosen(*app_).get_options()) {
    const OptionUsage usage = usage_of_option(*option, notes_);
    const auto note = notes_.find(option);
    const bool writes = note != notes_.end() && note->second.writes;
    const std::size_t equals = usage.name.find('=');
    const bool names_file = kind_of_name(usage.name.substr(equals + 1)) != ValueKind::text;
    for (const std::string& value : option->results()) {
      const bool alone = option->get_expected_max() == 0 && value == "true";
      const std::string after = equals == std::string::npos ? value : value.substr(value.find('=') + 1);
      out.push_back({usage.flags.empty() ? "" : usage.flags.back(), alone ? "" : value,
                     names_file && !usage.name.empty() ? after : "", writes});
    }
  }
  return out;
}

std::optional<std::string> CommandLine::run(const std::vector<std::string>& argv) {
  const auto refuse = [&](const char* code, const std::string& what, const std::string& hint) {
    throw libchar::usage_error(code, full_name(*app_)).says(what).hint(hint);
  };
  try {
    parse(argv);
  } catch (const CLI::Success& answer) {  // --help, --version
    std::ostringstream out, err;
    app_->exit(answer, out, err);
    return out.str();
  } catch (const CLI::ExtrasError&) {
    refuse("E0204", say_unknown(*app_), hint_for_extra(*app_));
  } catch (const CLI::ParseError& error) {
    refuse("E0205", error.what(), full_name(*app_) + " --help");
  }
  return std::nullopt;
}

}  // namespace sensorchar
