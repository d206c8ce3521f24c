#include "libchar/log/detail/odd_values.hpp"

#include <fmt/format.h>

namespace libchar {

std::string missing_cells(const std::vector<Channel>& channels,
                          const std::vector<std::uint64_t>& missing_per_channel) {
  std::string message = "empty or NaN cells, taken as missing samples";
  if (missing_per_channel.empty()) return message;
  message += " (";
  std::size_t listed = 0;
  for (std::size_t c = 0; c < missing_per_channel.size(); ++c) {
    if (missing_per_channel[c] == 0) continue;
    if (listed++ == 8) {
      message += ", …";
      break;
    }
    message +=
        fmt::format("{}{} {}", listed == 1 ? "" : ", ", channels[c].name, missing_per_channel[c]);
  }
  return message + ")";
}

}  // namespace libchar
