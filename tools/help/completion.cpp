#include "help/completion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sensorchar {
namespace {

/// In single quotes, for sh and its relatives.
std::string quoted_word(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

/// The same for fish, which escapes by a backslash inside single quotes.
std::string fish_quoted(std::string_view text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "'";
}

/// What stands before the first "; " or " (" of a help text: a menu has room for a few words.
std::string brief(const std::string& help) {
  std::string text = help.substr(0, std::min({help.find("; "), help.find(" ("), help.find(": ")}));
  constexpr std::size_t kMost = 72;
  if (text.size() <= kMost) return text;
  text.resize(text.rfind(' ', kMost));
  return text + " …";
}

std::string all_flags(const VerbUsage& verb) {
  std::string words;
  for (const OptionUsage& option : verb.options)
    for (const std::string& flag : option.flags) words += (words.empty() ? "" : " ") + flag;
  return words;
}

std::string all_verbs(const ProgramUsage& program) {
  std::string words = "help";
  for (const VerbUsage& verb : program.verbs) words += " " + verb.name;
  return words;
}

/// What bash offers behind a flag: "words a b", "list a b", "files", "folders", "none".
std::string bash_answer(const OptionUsage& option) {
  switch (option.kind) {
    case ValueKind::words:
      return fmt::format("{} {}", option.comma_list ? "list" : "words", fmt::join(option.words, " "));
    case ValueKind::file:
      return "files";
    case ValueKind::folder:
      return "folders";
    default:
      return "none";
  }
}

constexpr const char* kBashFrame = R"bash(
_@PROGRAM@_offer() {
  local kind=$1 word=$2 head
  shift 2
  case $kind in
    words) mapfile -t COMPREPLY < <(compgen -W "$*" -- "$word") ;;
    list)
      head=""
      [[ $word == *,* ]] && head=${word%,*},
      mapfile -t COMPREPLY < <(compgen -P "$head" -W "$*" -- "${word##*,}")
      compopt -o nospace 2>/dev/null
      ;;
    files)
      mapfile -t COMPREPLY < <(compgen -f -- "$word")
      compopt -o filenames 2>/dev/null
      ;;
    folders)
      mapfile -t COMPREPLY < <(compgen -d -- "$word")
      compopt -o filenames 2>/dev/null
      ;;
  esac
}

_@PROGRAM@() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} verb=${COMP_WORDS[1]} answer
  COMPREPLY=()
  # bash splits --type=oa at its sign.
  if [[ $word == "=" ]]; then
    word=""
  elif [[ $before == "=" ]]; then
    before=${COMP_WORDS[COMP_CWORD-2]}
  fi
  if (( COMP_CWORD == 1 )); then
    if [[ $word == -* ]]; then
      _@PROGRAM@_offer words "$word" @FLAGS@
    else
      _@PROGRAM@_offer words "$word" @VERBS@
    fi
    return
  fi
  if [[ $verb == help ]]; then
    (( COMP_CWORD == 2 )) && _@PROGRAM@_offer words "$word" @VERBS@
    return
  fi
  answer=$(_@PROGRAM@_value "$verb" "$before")
  if [[ -n $answer ]]; then
    _@PROGRAM@_offer "${answer%% *}" "$word" "${answer#* }"
  elif [[ $word == -* ]]; then
    _@PROGRAM@_offer words "$word" "$(_@PROGRAM@_flags "$verb")"
  else
    _@PROGRAM@_offer files "$word"
  fi
}
complete -F _@PROGRAM@ @PROGRAM@
)bash";

/// The frame with each mark replaced by its text.
std::string filled(std::string text, const std::vector<std::pair<std::string, std::string>>& marks) {
  for (const auto& [mark, value] : marks)
    for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + value.size()))
      text.replace(at, mark.size(), value);
  return text;
}

std::string zsh_help(const std::string& help) {
  std::string out;
  for (const char c : brief(help)) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zsh_value(const OptionUsage& option) {
  std::string name;
  for (const char c : option.name) name += c == ':' ? '.' : c;
  switch (option.kind) {
    case ValueKind::none:
      return "";
    case ValueKind::words:
      if (option.comma_list) return fmt::format(":{}:_values -s , word {}", name, fmt::join(option.words, " "));
      return fmt::format(":{}:({})", name, fmt::join(option.words, " "));
    case ValueKind::file:
      return fmt::format(":{}:_files", name);
    case ValueKind::folder:
      return fmt::format(":{}:_files -/", name);
    case ValueKind::text:
      return fmt::format(":{}: ", name);
  }
  return "";
}

/// One specification for _arguments: the flags of an option share what is said of them.
std::string zsh_option(const OptionUsage& option) {
  std::string line = "    ";
  const std::string rest = "[" + zsh_help(option.help) + "]" + zsh_value(option);
  std::string apart = fmt::format("{}", fmt::join(option.flags, " "));
  for (const std::string& other : option.excludes) apart += " " + other;
  const bool alone = option.flags.size() == 1;
  if (option.repeatable)
    line += "'*'";
  else if (!alone || !option.excludes.empty())
    line += "'(" + apart + ")'";
  line += alone ? option.flags.front() : fmt::format("{{{}}}", fmt::join(option.flags, ","));
  return line + quoted_word(rest) + " \\\n";
}

std::string fish_option(const ProgramUsage& program, const VerbUsage& verb, const OptionUsage& option) {
  std::string line = fmt::format("complete -c {} -n '__{}_verb {}'", program.name, program.name, verb.name);
  for (const std::string& flag : option.flags)
    line += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
  switch (option.kind) {
    case ValueKind::none:
      break;
    case ValueKind::words:
      line +=
          " -x -a " + fish_quoted(option.comma_list ? fmt::format("(__fish_complete_list , \"string split ' ' '{}'\")",
                                                                  fmt::join(option.words, " "))
                                                    : fmt::format("{}", fmt::join(option.words, " ")));
      break;
    case ValueKind::file:
      line += " -r -F";
      break;
    case ValueKind::folder:
      line += " -x -a '(__fish_complete_directories)'";
      break;
    case ValueKind::text:
      line += " -x";
      break;
  }
  return line + " -d " + fish_quoted(brief(option.help)) + "\n";
}

}  // namespace

std::string bash_completion(const ProgramUsage& program) {
  std::string text = fmt::format(
      "# bash completion of {0}: made by {0} --generate bash\n\n_{0}_flags() {{\n  case $1 in\n", program.name);
  for (const VerbUsage& verb : program.verbs)
    text += fmt::format("    {}) echo {} ;;\n", verb.name, quoted_word(all_flags(verb)));
  text += fmt::format(
      "  esac\n}}\n\n# Values of a flag of a verb; nothing for one without a value.\n_{}_value() {{\n  case \"$1 $2\" "
      "in\n",
      program.name);
  for (const VerbUsage& verb : program.verbs)
    for (const OptionUsage& option : verb.options) {
      if (option.kind == ValueKind::none) continue;
      std::string patterns;
      for (const std::string& flag : option.flags)
        patterns += (patterns.empty() ? "" : " | ") + quoted_word(verb.name + " " + flag);
      text += fmt::format("    {}) echo {} ;;\n", patterns, quoted_word(bash_answer(option)));
    }
  std::string own;
  for (const OptionUsage& option : program.options)
    for (const std::string& flag : option.flags) own += (own.empty() ? "" : " ") + flag;
  return text + "  esac\n}\n" +
         filled(kBashFrame, {{"@PROGRAM@", program.name},
                             {"@FLAGS@", quoted_word(own)},
                             {"@VERBS@", quoted_word(all_verbs(program))}});
}

std::string zsh_completion(const ProgramUsage& program) {
  std::string text = fmt::format("#compdef {0}\n# zsh completion of {0}: made by {0} --generate zsh\n\n", program.name);
  for (const VerbUsage& verb : program.verbs) {
    text += fmt::format("_{}_{}() {{\n  _arguments -S \\\n", program.name, verb.name);
    for (const OptionUsage& option : verb.options) text += zsh_option(option);
    text += "    '*:file:_files'\n}\n\n";
  }
  text += fmt::format("_{}_verbs() {{\n  local -a verbs\n  verbs=(\n", program.name);
  for (const VerbUsage& verb : program.verbs) text += "    " + quoted_word(verb.name + ":" + brief(verb.what)) + "\n";
  text += "    'help:what a verb does'\n  )\n  _describe verb verbs\n}\n\n";
  text += fmt::format(
      "_{0}() {{\n  if (( CURRENT == 2 )); then\n    _{0}_verbs\n    return\n  fi\n  local verb=$words[2]\n  shift "
      "words\n"
      "  (( CURRENT-- ))\n  if [[ $verb == help ]]; then\n    (( CURRENT == 2 )) && _{0}_verbs\n  elif (( "
      "$+functions[_{0}_$verb] )); then\n"
      "    _{0}_$verb\n  fi\n}}\n\nif [[ $funcstack[1] == _{0} ]]; then\n  _{0} \"$@\"\nelse\n  compdef _{0} {0}\nfi\n",
      program.name);
  return text;
}

std::string fish_completion(const ProgramUsage& program) {
  std::string text = fmt::format(
      "# fish completion of {0}: made by {0} --generate fish\n\nfunction __{0}_verb\n  set -l words (commandline "
      "-opc)\n"
      "  test (count $words) -ge 2; and test $words[2] = $argv[1]\nend\n\nfunction __{0}_no_verb\n"
      "  test (count (commandline -opc)) -eq 1\nend\n\n",
      program.name);
  for (const VerbUsage& verb : program.verbs)
    text += fmt::format("complete -c {} -n '__{}_no_verb' -f -a {} -d {}\n", program.name, program.name, verb.name,
                        fish_quoted(brief(verb.what)));
  text += fmt::format(
      "complete -c {0} -n '__{0}_no_verb' -f -a help -d 'what a verb does'\ncomplete -c {0} -n '__{0}_verb help' -f -a "
      "{1}\n",
      program.name, fish_quoted(all_verbs(program)));
  for (const OptionUsage& option : program.options)
    for (const std::string& flag : option.flags)
      if (flag.starts_with("--"))
        text += fmt::format("complete -c {0} -n '__{0}_no_verb' -f -l {1} -d {2}\n", program.name, flag.substr(2),
                            fish_quoted(brief(option.help)));
  for (const VerbUsage& verb : program.verbs)
    for (const OptionUsage& option : verb.options) text += fish_option(program, verb, option);
  return text;
}

}  // namespace sensorchar
