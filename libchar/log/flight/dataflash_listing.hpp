#pragma once
// What a DataFlash log holds, found in one pass over its messages: topics, one for each sensor of a
// kind, their rows and stamps.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/finding.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/flight/dataflash_format.hpp"
#include "libchar/log/recording.hpp"

namespace libchar {

/// A channel of a topic: a field, or one number of an array.
struct DataflashChannel {
  std::size_t field = 0;
  std::uint32_t byte = 0;
};

/// A field of stamps, over all messages of a topic.
struct DataflashClock {
  std::optional<std::uint32_t> byte;
  NumberType type = NumberType::u64;
  std::int64_t unit_ns = 1000;
  std::string name;
  std::uint64_t first = 0, last = 0;
};

struct DataflashTopic {
  std::optional<std::size_t> kind;  ///< nothing for bursts of the batch sampler
  std::int64_t instance = -1;
  std::vector<DataflashChannel> channels;  ///< one a field of the LogTopic
  DataflashClock logged, sampled;
  std::uint64_t rows = 0;
  std::uint64_t last_byte = 0;  ///< of its last message
  std::uint32_t batch_type = 0;
  std::uint64_t bursts = 0;
  std::uint32_t burst_samples = 0;  ///< of the longest
  double burst_rate_hz = 0;
};

inline constexpr std::uint64_t kDataflashLargestStamp = 9200000000000000;  ///< µs that fit 64-bit nanoseconds

/// A burst of the batch sampler, as its header (ISBH) says: value = count / multiplier, sample k at start + k / rate.
struct DataflashBurst {
  std::uint32_t number = 0, type = 0, instance = 0, samples = 0;
  double multiplier = 0, rate_hz = 0;
  std::uint64_t start_us = 0;
};

/// Follows the batch sampler: headers, and the blocks that belong to them.
class DataflashBatches {
 public:
  static bool is_header(const DataflashKind& kind);
  static bool is_block(const DataflashKind& kind);
  void take_header(const DataflashKind& kind, std::span<const std::byte> body);
  /// The burst that a block belongs to, nullptr when its header is not there or cannot be used.
  const DataflashBurst* burst_of(const DataflashKind& kind, std::span<const std::byte> body) const;
  /// The number of the block's first sample in its burst.
  static std::uint32_t first_sample(const DataflashKind& kind, std::span<const std::byte> body);

 private:
  std::optional<DataflashBurst> burst_;
};

struct DataflashListing {
  DataflashFormats formats;
  std::vector<LogTopic> topics;
  std::vector<DataflashTopic> contents;  ///< one a topic
  std::string firmware;                  ///< the first text that the log shows
  Findings losses;
};

/// The instance that a message is of, -1 where its kind has none.
std::int64_t dataflash_instance(const DataflashKind& kind, std::span<const std::byte> body);

DataflashListing list_dataflash(const BinaryFile& file, std::size_t block_bytes);

}  // namespace libchar
