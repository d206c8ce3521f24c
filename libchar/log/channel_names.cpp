#include "libchar/log/channel_names.hpp"

#include <algorithm>
#include <set>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/log/detail/channel_choice.hpp"

namespace libchar {
namespace {

std::vector<std::string> names_in_head(const std::string& path, const ReadOptions& options) {
  std::vector<std::string> names;
  for (const Channel& channel : read_log_head(path, options).channels) names.push_back(channel.name);
  return names;
}

// New names stand for all columns; else the reader chooses as for `channels`.
std::vector<std::string> chosen_by(const std::string& word, const std::string& path, ReadOptions options,
                                   const std::vector<std::string>& all) {
  if (std::find(all.begin(), all.end(), word) != all.end()) return {word};
  if (options.names.empty()) {
    options.channels = {word};
    return names_in_head(path, options);
  }
  std::vector<std::string> out;
  std::copy_if(all.begin(), all.end(), std::back_inserter(out),
               [&](const std::string& name) { return is_pattern(word) && matches(word, name); });
  if (const auto k = position_in(word, all.size()); out.empty() && k) return {all[*k]};
  if (out.empty()) refuse_channel(word, all, options, path);
  return out;
}

}  // namespace

std::vector<std::string> names_in_log(const std::string& path, const ReadOptions& options) {
  ReadOptions plain = options;
  plain.names.clear();
  plain.units.clear();
  plain.channel_scale.clear();
  plain.channel_unit.clear();
  plain.unsaid.channel_rate.clear();
  return names_in_head(path, plain);
}

ReadOptions options_of_channels(const ReadOptions& options, const std::vector<Channel>& all,
                                const std::vector<std::string>& in_log, const std::vector<std::size_t>& some) {
  ReadOptions out = options;
  const auto fits = [&](const std::string& word, std::size_t c) {
    return matches(word.substr(0, word.rfind('=')), all[c].name);
  };
  // A word that fits no channel at all stays, and is told as a slip.
  const auto is_of_others = [&](const std::string& word) {
    bool any = false;
    for (std::size_t c = 0; c < all.size(); ++c) any |= fits(word, c);
    return any && std::none_of(some.begin(), some.end(), [&](std::size_t c) { return fits(word, c); });
  };
  std::erase_if(out.channel_scale, is_of_others);
  std::erase_if(out.channel_unit, is_of_others);
  const auto pick = [&](const std::vector<std::string>& list) {
    std::vector<std::string> picked;
    for (const std::size_t c : some) picked.push_back(list[c]);
    return picked;
  };
  out.channels = pick(in_log);
  if (!options.names.empty()) out.names = pick(options.names);
  if (options.units.size() > 1) out.units = pick(options.units);
  return out;
}

std::vector<std::vector<std::string>> channel_names(const std::string& path, const ReadOptions& options,
                                                    const std::vector<std::string>& words,
                                                    const std::vector<std::string>& except) {
  ReadOptions head = options;
  head.channels.clear();
  head.channel_scale.clear();
  head.channel_unit.clear();
  head.unsaid.channel_rate.clear();
  head.units.clear();  // one a channel that is chosen: not known yet
  head.hash = false;
  const std::vector<std::string> all = options.names.empty() ? names_in_head(path, head) : options.names;
  std::vector<std::vector<std::string>> out;
  out.reserve(words.size());
  std::set<std::string> taken(except.begin(), except.end());
  for (const std::string& word : words) out.push_back(chosen_by(word, path, head, all));
  const auto wild = [&](std::size_t k) {
    return is_pattern(words[k]) && (out[k].size() != 1 || out[k][0] != words[k]);
  };
  for (std::size_t k = 0; k < words.size(); ++k)
    if (!wild(k)) taken.insert(out[k].begin(), out[k].end());
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (!wild(k)) continue;
    std::erase_if(out[k], [&](const std::string& name) { return !taken.insert(name).second; });
    if (out[k].empty())
      throw usage_error("E0320", path)
          .says("every channel that matches is named elsewhere")
          .got(words[k])
          .hint("leave the pattern out");
    std::sort(out[k].begin(), out[k].end(), comes_before);
  }
  return out;
}

}  // namespace libchar
