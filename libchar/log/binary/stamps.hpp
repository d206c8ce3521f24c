#pragma once
// Stamps stored as binary numbers become whole nanoseconds: exactly where they are integers, even
// where a double could not hold them.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>

#include "libchar/log/binary/number_type.hpp"

namespace libchar {

/// ns = (number * scale + offset) * unit_ns.
struct StampFormat {
  NumberFormat number;
  double scale = 1, offset = 0;
  std::int64_t unit_ns = 1;
};

/// Reads out.size() stamps that stand `stride` bytes apart from `first`. `where` says where stamp i stands, for the
/// front of an error. Throws Error(input) for a stamp that is NaN (E0313) or does not fit 64-bit nanoseconds (E0314).
void read_stamps(const std::byte* first, std::size_t stride, const StampFormat& format, std::span<std::int64_t> out,
                 const std::function<std::string(std::size_t i)>& where);

}  // namespace libchar
