#pragma once
// What a ULog holds, found in one pass over the heads of its messages: topics, their formats, rows
// and stamps, and what is lost.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/flight/ulog_format.hpp"
#include "libchar/log/flight/ulog_walk.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// Where a FIFO message has what its samples are made of.
struct UlogFifo {
  std::uint32_t dt = 0, scale = 0, samples = 0;
  std::array<std::uint32_t, 3> axes{};
  std::uint32_t room = 0;  ///< samples that a message can hold
};

/// One field of stamps in µs over all messages of a topic.
struct UlogStamps {
  std::optional<std::uint32_t> byte;             ///< where it stands in a message
  std::uint64_t first = 0, last = 0, zeros = 0;  ///< of those that are not zero
};

struct UlogTopic {
  std::string message;  ///< "sensor_gyro"
  UlogLayout layout;
  UlogStamps published, sampled;
  std::optional<UlogFifo> fifo;
  std::uint64_t messages = 0, rows = 0, rows_of_first = 0;
  std::uint64_t first_byte = 0, last_byte = 0;  ///< of its first and last message
};

struct UlogListing {
  std::vector<LogTopic> topics;
  std::vector<UlogTopic> contents;  ///< one a topic
  std::vector<std::optional<std::size_t>> topic_of_id;
  std::vector<UlogSizes> sizes;  ///< by the id of a message
  std::map<std::string, std::string> info;
  std::uint64_t dropouts = 0, dropped_ms = 0;
  std::vector<std::string> dropout_places;
  Findings losses;
};

/// `by_publication`: rates and stamps are those of publication, where a message has both.
UlogListing list_ulog(const BinaryFile& file, const UlogHeader& header, std::size_t block_bytes, bool by_publication);

/// When a sample was taken, where messages say it and it is not always zero; else when they were published.
const UlogStamps& ulog_stamps(const UlogTopic& content, bool by_publication);

/// What a field is called in its own message, without an index: "gyro_rad" of "gyro_rad[0]", "rpm" of "esc[1].rpm".
inline std::string_view plain_name(std::string_view name) {
  if (const auto dot = name.rfind('.'); dot != std::string_view::npos) name.remove_prefix(dot + 1);
  return name.substr(0, name.find('['));
}

}  // namespace libchar
