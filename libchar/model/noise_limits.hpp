#pragma once
// What a data sheet or a test plan allows of each noise term: a document of upper limits in the units of data sheets.
//
//   format: noise-limits
//   version: 1
//   limits:
//     - kind: angular_rate
//       white_noise: {value: 2, unit: deg/√h}
//       bias_instability: {value: 25, unit: deg/h, reading: floor}

#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/fields.hpp"
#include "libchar/core/noise_terms.hpp"

namespace libchar {

/// Limits of some channels. Its values wait for the unit of a channel (limits_for).
struct LimitBlock {
  std::vector<std::string> channels;  ///< by name; empty: by kind
  std::string kind;                   ///< a word of Quantity, by the channel's unit; empty: every channel
  std::string density;                ///< "one-sided", "two-sided": of values per √Hz
  Document node;                      ///< the block as written in the file
};

struct NoiseLimits {
  std::string file;
  std::string sensor;  ///< whose limits they are, in words
  std::vector<LimitBlock> blocks;
};

struct NamedChannel {
  std::string name, unit;
};

/// One limit of one channel.
struct ChannelLimit {
  std::size_t channel = 0;  ///< index
  Term term = Term::white;
  double most = 0;   ///< in the term's own unit (core/units.hpp), two-sided
  std::string text;  ///< as in the file: "2 deg/√h"
  int line = 0;      ///< of the file
};

/// The keys of the file, and of an element of `limits`; those of a term within.
const Fields<NoiseLimits>& limits_fields();
const Fields<LimitBlock>& limit_block_fields();

/// Reads `format: noise-limits`, `version: 1`, YAML or JSON. Throws Error(input) with place, key
/// and the nearest valid key.
NoiseLimits parse_limits(std::string_view text, const std::string& file);
/// The same from a file: at most 16 MiB, a regular file.
NoiseLimits read_limits_file(const std::string& path);

/// The limits that hold for these channels, by channel and term. Throws Error(input) with its place for a name or a
/// kind that none of the channels has, and for a unit that does not fit a channel's. Throws it as well for a term that
/// is limited twice for one channel.
std::vector<ChannelLimit> limits_for(const NoiseLimits& limits, const std::vector<NamedChannel>& channels);

}  // namespace libchar
