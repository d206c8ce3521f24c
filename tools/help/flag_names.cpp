#include "help/flag_names.hpp"

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace sensorchar {
namespace {

struct FlagName {
  std::string_view option;  ///< of the library
  std::string_view flag;
};

// In the order of the alphabet. A function of the library stands for the command that calls it.
constexpr FlagName kFlags[] = {{"algorithm", "--algorithm"},
                               {"algorithms", "sensorchar replay --list"},
                               {"align", "--align"},
                               {"allow_outside", "--allow-outside"},
                               {"anyway", "--anyway"},
                               {"average", "--average"},
                               {"axes", "--axes"},
                               {"axis", "--axis"},
                               {"band_hz", "--band"},
                               {"bias_tau_s", "--airsim-tau"},
                               {"budget_s", "--budget"},
                               {"by_channel", "--by-channel"},
                               {"channel_rate", "--rate"},
                               {"channel_scale", "--scale"},
                               {"channel_unit", "--unit"},
                               {"channels", "--channel"},
                               {"check", "--fail-if"},
                               {"compare_replays", "--unlike"},
                               {"correlation_s", "--correlation-time"},
                               {"curve", "--curve"},
                               {"data", "--data"},
                               {"date_order", "--date-order"},
                               {"decimal", "--decimal"},
                               {"delimiter", "--delimiter"},
                               {"deterministic", "--deterministic"},
                               {"drop_bad_rows", "--bad-rows drop"},
                               {"dtype", "--dtype"},
                               {"duration_s", "--duration"},
                               {"dynamic", "--dynamic"},
                               {"encoding", "--encoding"},
                               {"explain_replay", "--explain"},
                               {"export_targets", "sensorchar model --list"},
                               {"fault", "--fault"},
                               {"fault_free_s", "--fault-free"},
                               {"filter_step_s", "--filter-step"},
                               {"floor_tau_s", "--floor-tau"},
                               {"format", "--format"},
                               {"from_s", "--from"},
                               {"frozen", "--frozen"},
                               {"full_overlap", "--full-overlap"},
                               {"gravity", "--gravity"},
                               {"group_by", "--group-by"},
                               {"header", "--header"},
                               {"high_pass_hz", "--high-pass"},
                               {"inflate", "--inflate"},
                               {"input", "--input"},
                               {"interpolated", "--interpolated"},
                               {"kind", "--kind"},
                               {"labels", "--label"},
                               {"learning", "--learning"},
                               {"map", "--map"},
                               {"memory_bytes", "--memory"},
                               {"missing", "--missing"},
                               {"model", "--model"},
                               {"models", "--models"},
                               {"msg", "--msg"},
                               {"names", "--names"},
                               {"nominal_frequency", "--nominal-frequency"},
                               {"older", "--older"},
                               {"order", "--order"},
                               {"overflow_as_missing", "--overflow nan"},
                               {"overlap", "--overlap"},
                               {"overwrite", "--force"},
                               {"partial", "--partial"},
                               {"preset", "--preset"},
                               {"program", "--program"},
                               {"published", "--published"},
                               {"quantity", "--quantity"},
                               {"rate_hz", "--rate"},
                               {"reference", "--reference"},
                               {"reference_log", "--reference-log"},
                               {"reference_offset", "--reference-offset"},
                               {"resample_hz", "--resample"},
                               {"scaling", "--scaling"},
                               {"segment", "--segment"},
                               {"sensors", "--sensors"},
                               {"skip_repeated_header", "--repeated-header skip"},
                               {"skip_rows", "--skip-rows"},
                               {"skip_unreadable", "--skip-unreadable"},
                               {"still", "--still"},
                               {"target", "--to"},
                               {"taus_s", "--taus"},
                               {"temperature", "--temperature"},
                               {"time_column", "--time-column"},
                               {"time_source", "--time-source"},
                               {"time_unit", "--time-unit"},
                               {"to_s", "--to"},
                               {"topic", "--topic"},
                               {"type", "--type"},
                               {"units", "--units"},
                               {"unwrap", "--unwrap"},
                               {"where", "--where"},
                               {"x_range", "--x-range"},
                               {"y_range", "--y-range"}};

/// What mends a record before its noise is fitted: other verbs name the one that does it.
constexpr std::string_view kOfAnalysis[] = {"--data",  "--frozen",      "--interpolated",
                                            "--still", "--temperature", "--unwrap"};

const std::set<std::string>* g_of_verb = nullptr;  // of the verb that runs

/// `used` gets the flags.
std::string replaced(const std::string& message, std::vector<std::string_view>& used) {
  std::string text;
  std::size_t done = 0;
  for (std::size_t open = message.find('`'); open != std::string::npos;) {
    const std::size_t close = message.find('`', open + 1);
    if (close == std::string::npos) break;
    const std::string_view name(message.data() + open + 1, close - open - 1);
    const auto* row =
        std::find_if(std::begin(kFlags), std::end(kFlags), [&](const FlagName& f) { return f.option == name; });
    if (row == std::end(kFlags)) {
      open = close;
      continue;
    }
    text += message.substr(done, open - done);
    if (g_of_verb != nullptr && !g_of_verb->contains(std::string(row->flag)) &&
        std::find(std::begin(kOfAnalysis), std::end(kOfAnalysis), row->flag) != std::end(kOfAnalysis) &&
        text.rfind("characterize ") == std::string::npos)
      text += "characterize ";
    text += row->flag;
    used.push_back(row->flag);
    done = close + 1;
    open = message.find('`', done);
  }
  return text + message.substr(done);
}

}  // namespace

void set_flags_of_verb(const std::set<std::string>& flags) { g_of_verb = &flags; }

std::vector<std::pair<std::string, std::string>> flags_of_options() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const FlagName& name : kFlags)
    if (name.flag.starts_with("--")) out.emplace_back(name.option, name.flag);
  return out;
}

std::string with_flags(const std::string& message) {
  std::vector<std::string_view> used;
  return replaced(message, used);
}

libchar::Problem with_flags(libchar::Problem problem, const std::set<std::string>& of_verb) {
  problem.where = with_flags(problem.where);
  problem.what = with_flags(problem.what);
  std::vector<std::string_view> used;
  problem.hint = replaced(problem.hint, used);
  for (const std::string_view flag : used)
    if (!of_verb.empty() && flag.starts_with("--") && !of_verb.contains(std::string(flag.substr(0, flag.find(' ')))))
      problem.hint.clear();
  return problem;
}

}  // namespace sensorchar
