#pragma once
// Which channels of a log somebody means, before its samples are read.

#include <string>
#include <vector>

#include "libchar/log/read.hpp"

namespace libchar {

/// What a log says of itself before its samples: channels (those that `options` choose, with
/// their new names and units), format, dialect. Rate and length are not known yet. Throws as read_log.
LogInfo read_log_head(const std::string& path, const ReadOptions& options);

/// The channels that each of `words` stands for: a name, a position c0, c1…, or a pattern with * and ?.
/// A word that is a name is that channel. A pattern stands for the channels that match, in natural order,
/// less those that another word names, an earlier pattern took, or `except` holds. Throws Error(usage)
/// for a word without a channel (E0320), with the existing channels.
std::vector<std::vector<std::string>> channel_names(const std::string& path, const ReadOptions& options,
                                                    const std::vector<std::string>& words,
                                                    const std::vector<std::string>& except = {});

/// What the log itself calls the channels that `options` read.
std::vector<std::string> names_in_log(const std::string& path, const ReadOptions& options);

/// Options that read only `some` of the channels that `options` read (`all`, with their names in the end; `in_log` as
/// the log calls them), each with the name, unit and factor that it has among all.
ReadOptions options_of_channels(const ReadOptions& options, const std::vector<Channel>& all,
                                const std::vector<std::string>& in_log, const std::vector<std::size_t>& some);

}  // namespace libchar
