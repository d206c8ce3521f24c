#pragma once
// The command line in a few functions. Only command_line.cpp knows the parser behind them:
// its templates are compiled there once, not in every verb.

#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/document/enum_table.hpp"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace sensorchar {

struct Session;
struct VerbEntry;
struct Example;
struct ProgramUsage;
struct VerbUsage;

/// Properties of an option that the parser does not know.
struct OptionNote {
  std::vector<std::string> words;  ///< the values that are known beforehand
  std::string only;                ///< where it has an effect ("with --curve"), "" everywhere
  std::function<bool()> works;     ///< has it one in this command? asked where it is given
  bool alone = false;              ///< nothing else is asked where it is given, but how to print it
  bool writes = false;             ///< where results go, or what may be overwritten
  bool once_each = false;          ///< of several values none is for what another is for
};
using OptionNotes = std::map<const CLI::Option*, OptionNote>;

/// An option or argument that was added, for what holds for few of them.
class Option {
 public:
  Option(CLI::Option* option, OptionNotes* notes) : option_(option), notes_(notes) {}
  Option& required();
  /// Its heading in the help.
  Option& group(const std::string& heading);
  /// What stands for its value in the help ("FILE").
  Option& value_name(const std::string& name);
  /// Lists: one value after each flag, which may hold several separated by commas.
  Option& separated_by_commas();
  /// Lists: exactly one value after each flag.
  Option& one_value_each();
  Option& excludes(const Option& other);
  /// Values that are offered by the completion and the man page; others are not refused.
  Option& known_words(std::vector<std::string> words);
  /// It has an effect only there ("with --curve"): the help says so, and where it is given and `works` says no,
  /// it is refused.
  Option& only(const std::string& where, std::function<bool()> works);
  /// It asks for something else than the verb does: but --json and how to print, no other option goes with it.
  Option& alone();
  /// It says where results go, or what may be overwritten.
  Option& writes();
  /// Lists: of "a=1,a=2" and "a,a" the second is refused.
  Option& once_each();

 private:
  CLI::Option* option_;
  OptionNotes* notes_;
};

/// The options of one verb. Names are "FILE" (an argument by its place), "--force", or "-o,--output". Variables must
/// live until the verb has run, and keep their value where an option is not given; defaults must be stated in `help`.
/// What an option refuses is Error(usage) that names the option. A value that is called LOG, FILE, MODEL, SCENE, CURVE,
/// RUN, DIR or FOLDER is completed as a file or folder.
class VerbOptions {
 public:
  VerbOptions(CLI::App& app, OptionNotes& notes) : app_(&app), notes_(&notes) {}

  /// `Option::only` of options that were added.
  void only(const std::string& where, const std::function<bool()>& works, const std::vector<std::string>& flags);

  Option add_flag(const std::string& names, bool& value, const std::string& help);
  Option add_text(const std::string& names, std::string& value, const std::string& help);
  Option add_texts(const std::string& names, std::vector<std::string>& values, const std::string& help);
  /// `read` gets the text; `value_name` stands for it in the help.
  Option add_parsed(const std::string& names, const std::string& value_name,
                    std::function<void(const std::string&)> read, const std::string& help);
  /// The same for each of several values, given one after the other or separated by commas.
  Option add_parsed_each(const std::string& names, const std::string& value_name,
                         std::function<void(const std::string&)> read, const std::string& help);
  Option add_number(const std::string& names, std::optional<double>& value, const std::string& help,
                    double lowest = -std::numeric_limits<double>::max(),
                    double highest = std::numeric_limits<double>::max());
  Option add_number(const std::string& names, double& value, const std::string& help,
                    double lowest = -std::numeric_limits<double>::max(),
                    double highest = std::numeric_limits<double>::max());
  Option add_count(const std::string& names, std::uint64_t& value, const std::string& help, std::uint64_t lowest = 0,
                   std::uint64_t highest = std::numeric_limits<std::uint64_t>::max());
  /// Seconds ("90", "1.5h"), above zero.
  Option add_duration(const std::string& names, std::optional<double>& seconds, const std::string& help);
  /// Seconds after a beginning, which 0 is.
  Option add_instant(const std::string& names, std::optional<double>& seconds, const std::string& help);
  /// Hertz ("200", "1.5kHz").
  Option add_rate(const std::string& names, std::optional<double>& hertz, const std::string& help);
  /// Bytes ("4096", "64KiB").
  Option add_bytes(const std::string& names, std::uint64_t& bytes, const std::string& help);
  /// A value of an enum by its word (core/enum_table.hpp).
  template <libchar::EnumWithTable Enum>
  Option add_enum(const std::string& names, Enum& value, const std::string& help) {
    return add_word(names, libchar::words_of<Enum>(), help,
                    [&value](const std::string& word) { value = *libchar::find_enum<Enum>(word); });
  }
  /// -o FILE of a verb that writes one document; "" is stdout, and so is -.
  Option add_document_output(std::string& path);
  /// One of a few words; a wrong one is refused with the nearest right one.
  Option add_choice(const std::string& names, std::string& value, std::vector<std::string> words,
                    const std::string& help);
  /// One or more of them, separated by commas, none twice.
  Option add_choices(const std::string& names, std::vector<std::string>& values, std::vector<std::string> words,
                     const std::string& help);

 private:
  Option add_word(const std::string& names, std::vector<std::string> words, const std::string& help,
                  std::function<void(const std::string&)> use);

  Option added(CLI::Option* option) { return {option, notes_}; }

  CLI::App* app_;
  OptionNotes* notes_;
};

/// Verbs of two words ("fleet plan") are called with a hyphen between them; here they are joined. A
/// first word alone, or with a second that is not its verb, is refused, and the message lists the
/// verbs; any request for help on a first word becomes "help fleet".
std::vector<std::string> with_joined_verb(const std::vector<std::string>& command,
                                          const std::vector<std::string>& verbs);

/// A word of a command as its verb understands it.
struct ParsedWord {
  std::string flag;   ///< "--output"; "" for a positional argument
  std::string value;  ///< one of several; "" of a flag
  std::string file;   ///< the file or folder that it names, "" where it names none
  bool writes = false;
};

/// A program with verbs.
class CommandLine {
 public:
  /// `footer` is the last line of the help.
  CommandLine(const std::string& program, const std::string& what, const std::string& version,
              const std::string& footer);
  ~CommandLine();
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  /// Adds a verb with its options and those that every verb has (--quiet).
  void add(const VerbEntry& verb, Session& session);
  /// Everything that was added, for help, man pages and completions.
  ProgramUsage usage() const;
  /// Parses argv and runs the verb that was chosen. Returns what is to be printed instead (--version), or nothing.
  /// Throws Error(usage) for what cannot be understood, and whatever the verb throws.
  std::optional<std::string> run(const std::vector<std::string>& argv);
  /// The same words as the verb's own options take them, and nothing is run. Throws as `run`.
  std::vector<ParsedWord> parsed(const std::vector<std::string>& argv);

 private:
  void parse(const std::vector<std::string>& argv);

  VerbUsage usage_of(const CLI::App& verb) const;

  std::unique_ptr<CLI::App> app_;
  OptionNotes notes_;
  bool only_parses_ = false;
  std::map<std::string, std::vector<Example>> examples_;  ///< of each verb
};

}  // namespace sensorchar
