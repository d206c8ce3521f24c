#include "libchar/log/topics/topic_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "libchar/core/error.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

bool readable(const LogTopic& topic) {
  return topic.why_not.empty() && !topic.fields.empty();
}

std::vector<std::string> readable_names(const std::vector<LogTopic>& topics) {
  std::vector<std::string> names;
  for (const LogTopic& topic : topics)
    if (readable(topic)) names.push_back(topic.name);
  return names;
}

[[noreturn]] void refuse(const std::string& file,
                         std::string what,
                         const std::string& got,
                         std::string hint) {
  throw Error({ErrorKind::usage, "E0425", file, std::move(what), got, std::move(hint)});
}

void refuse_unreadable(const LogTopic& topic, const std::string& file) {
  if (readable(topic)) return;
  refuse(file,
         topic.why_not.empty() ? "this topic holds no numbers"
                               : fmt::format("this topic cannot be read: {}", topic.why_not),
         topic.name,
         "inspect lists the topics");
}

// "/imu0/angular_velocity.x" and "/imu0.angular_velocity.x" are a field of /imu0; the longest topic that fits is meant.
std::optional<std::pair<std::size_t, std::string>> qualified(const std::vector<LogTopic>& topics,
                                                             const std::string& word) {
  std::optional<std::size_t> found;
  for (std::size_t t = 0; t < topics.size(); ++t) {
    const std::string& name = topics[t].name;
    const bool fits = !name.empty() && word.size() > name.size() + 1 && word.starts_with(name) &&
                      (word[name.size()] == '/' || word[name.size()] == '.');
    if (fits && (!found || name.size() > topics[*found].name.size())) found = t;
  }
  if (!found) return std::nullopt;
  return std::pair(*found, word.substr(topics[*found].name.size() + 1));
}

bool field_fits(const std::string& word, const LogTopic& topic, const Channel& field) {
  if (word == field.name) return true;
  if (!is_pattern(word)) return false;
  return matches(word, field.name) || matches(word, topic.name + "/" + field.name) ||
         matches(word, topic.name + "." + field.name);
}

// The topics that hold what a word of `channels` names.
std::set<std::size_t> topics_of(const std::vector<LogTopic>& topics, const std::string& word) {
  if (const auto whole = qualified(topics, word)) return {whole->first};
  std::set<std::size_t> found;
  for (std::size_t t = 0; t < topics.size(); ++t)
    if (std::any_of(topics[t].fields.begin(), topics[t].fields.end(), [&](const Channel& field) {
          return field_fits(word, topics[t], field);
        }))
      found.insert(t);
  return found;
}

// The fields that a word means in one topic, by their own names; the word itself when that is for
// the reader to say (c0, a slip).
std::vector<std::string> fields_of(const LogTopic& topic, const std::string& word) {
  std::vector<std::string> fields;
  for (const Channel& field : topic.fields)
    if (field_fits(word, topic, field)) fields.push_back(field.name);
  if (fields.empty()) fields.push_back(word);
  return fields;
}

TopicChoice choice_of(const std::vector<LogTopic>& topics,
                      std::size_t topic,
                      const ReadOptions& options) {
  TopicChoice choice;
  choice.topic = topic;
  for (const std::string& word : options.channels) {
    const auto whole = qualified(topics, word);
    for (std::string& field :
         fields_of(topics[topic], whole && whole->first == topic ? whole->second : word))
      choice.channels.push_back(std::move(field));
  }
  return choice;
}

// "sensor_gyro 0" and "GYR 1" are streams of one name, which is enough where there is one.
bool is_instance_of(const std::string& name, const std::string& wanted) {
  const std::size_t front = wanted.size() + 1;
  return name.size() > front && name.starts_with(wanted) && name[wanted.size()] == ' ' &&
         name.find_first_not_of("0123456789", front) == std::string::npos;
}

std::size_t named_topic(const std::vector<LogTopic>& topics,
                        const std::string& wanted,
                        const std::string& file) {
  std::vector<std::size_t> found;
  for (std::size_t t = 0; t < topics.size(); ++t) {
    if (topics[t].name == wanted) return t;
    const bool fits = is_pattern(wanted) ? matches(wanted, topics[t].name)
                                         : is_instance_of(topics[t].name, wanted);
    if (fits && readable(topics[t])) found.push_back(t);
  }
  if (found.size() == 1) return found[0];
  const std::vector<std::string> names = readable_names(topics);
  if (found.size() > 1)
    refuse(file,
           "several topics match this name, one is read at a time",
           wanted,
           fmt::format("`topic` {} chooses one", topics[found.front()].name));
  refuse(file,
         "there is no topic of this name",
         wanted,
         did_you_mean(nearest(wanted, names), "it has " + first_names(names)));
}

std::size_t topic_of_channels(const std::vector<LogTopic>& topics,
                              const ReadOptions& options,
                              const std::string& file) {
  std::optional<std::set<std::size_t>> common;
  for (const std::string& word : options.channels) {
    const std::set<std::size_t> found = topics_of(topics, word);
    if (found.empty())
      refuse(file,
             "no topic has a channel of this name",
             word,
             "inspect lists topics and their fields; `topic` chooses one");
    if (!common) {
      common = found;
      continue;
    }
    std::erase_if(*common, [&](std::size_t t) { return found.count(t) == 0; });
    if (common->empty())
      refuse(file,
             "these channels are of several topics, each of which has a clock of its own",
             fmt::format("{}", fmt::join(options.channels, ",")),
             "read one topic at a time");
  }
  if (common->size() == 1) return *common->begin();
  std::vector<std::string> names;
  for (const std::size_t t : *common) names.push_back(topics[t].name);
  refuse(file,
         fmt::format("several topics have this channel: {}", first_names(names)),
         options.channels.front(),
         fmt::format("`topic` {} chooses one", names.front()));
}

// What a log lost says why nothing of it can be read.
[[noreturn]] void refuse_unreadable_log(const std::vector<LogTopic>& topics,
                                        const std::string& file,
                                        const Warnings& losses) {
  std::string what, got, hint;
  if (!topics.empty()) {
    const std::string& why = topics.front().why_not;
    what = "none of its topics holds numbers that can be read";
    got = topics.front().name + (why.empty() ? "" : ": " + why);
  } else if (losses.empty()) {
    what = "holds no messages and no arrays";
    hint = "if it should hold some, it was cut behind its beginning: copy it again";
  } else {
    what = "holds no whole message";
  }
  if (!losses.empty()) {
    const Warning& first = losses.list().front();
    what += ": " + first.sentence;
    if (!first.where.rows.empty()) what += fmt::format(" ({})", first.where.rows.front());
  }
  throw Error({ErrorKind::input, "E0426", file, std::move(what), std::move(got), std::move(hint)});
}

}  // namespace

std::optional<TopicChoice> choose_topic(const std::vector<LogTopic>& topics,
                                        const ReadOptions& options,
                                        const std::string& file) {
  if (!options.topic.empty()) {
    const std::size_t t = named_topic(topics, options.topic, file);
    refuse_unreadable(topics[t], file);
    return choice_of(topics, t, options);
  }
  std::vector<std::size_t> usable, sensors;
  for (std::size_t t = 0; t < topics.size(); ++t) {
    if (!readable(topics[t])) continue;
    usable.push_back(t);
    if (topics[t].sensor) sensors.push_back(t);
  }
  if (usable.size() == 1) return choice_of(topics, usable[0], options);
  if (!options.channels.empty() && !usable.empty()) {
    const std::size_t t = topic_of_channels(topics, options, file);
    refuse_unreadable(topics[t], file);
    return choice_of(topics, t, options);
  }
  if (sensors.size() != 1) return std::nullopt;
  TopicChoice choice = choice_of(topics, sensors[0], options);
  choice.guess =
      fmt::format("topic: {}, the only one of {} that is a sensor's (`topic` takes another one)",
                  printable(topics[sensors[0]].name),
                  usable.size());
  return choice;
}

void refuse_without_topic(const std::vector<LogTopic>& topics,
                          const std::string& file,
                          const Warnings& losses) {
  const std::vector<std::string> names = readable_names(topics);
  if (names.empty()) refuse_unreadable_log(topics, file, losses);
  throw Error(
      {ErrorKind::usage,
       "E0427",
       file,
       fmt::format(
           "holds {} topics, each with a clock of its own: {}", names.size(), first_names(names)),
       "",
       fmt::format("`topic` {} chooses one", names.front())});
}

}  // namespace libchar
