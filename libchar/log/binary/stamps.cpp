#include "libchar/log/binary/stamps.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"

namespace libchar {
namespace {

using Places = std::function<std::string(std::size_t)>;

// number * scale + offset in whole nanoseconds.
struct WholeStamps {
  std::int64_t scale_ns = 1, offset_ns = 0;
};

std::optional<WholeStamps> whole_stamps(const StampFormat& format) {
  if (is_float(format.number.type)) return std::nullopt;
  const double scale = format.scale * static_cast<double>(format.unit_ns),
               offset = format.offset * static_cast<double>(format.unit_ns);
  const auto whole = [](double x) { return std::abs(x) < 0x1p63 && x == std::trunc(x); };
  if (!whole(scale) || !whole(offset)) return std::nullopt;
  return WholeStamps{static_cast<std::int64_t>(scale), static_cast<std::int64_t>(offset)};
}

[[noreturn]] void refuse_stamp(std::string where, double got) {
  throw input_error("E0314", std::move(where))
      .says("a time stamp does not fit 64-bit nanoseconds")
      .got(shortest(got))
      .hint("is the time unit right? `time_unit` sets it");
}

void read_whole_stamps(const std::byte* first, std::size_t stride, const StampFormat& format, const WholeStamps& line,
                       std::span<std::int64_t> out, const Places& where) {
  if (const auto bad = read_integers(first, stride, format.number, out)) refuse_stamp(where(*bad), 1.8e19);
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto stored = static_cast<double>(out[i]);
    if (__builtin_mul_overflow(out[i], line.scale_ns, &out[i]) ||
        __builtin_add_overflow(out[i], line.offset_ns, &out[i]))
      refuse_stamp(where(i), stored * format.scale + format.offset);
  }
}

void read_real_stamps(const std::byte* first, std::size_t stride, const StampFormat& format,
                      std::span<std::int64_t> out, const Places& where) {
  std::vector<double> stamps(out.size());
  read_numbers(first, stride, format.number, stamps);
  for (std::size_t i = 0; i < out.size(); ++i) {
    if (std::isnan(stamps[i]))
      throw input_error("E0313", where(i))
          .says("missing time stamp")
          .got("nan")
          .hint("`time_column` none and `rate_hz` HZ ignore the stamps");
    const double stamp = stamps[i] * format.scale + format.offset;
    const double ns = stamp * static_cast<double>(format.unit_ns);
    if (!(std::abs(ns) < 9.2e18)) refuse_stamp(where(i), stamp);
    out[i] = clamped_whole<std::int64_t>(std::round(ns));
  }
}

}  // namespace

void read_stamps(const std::byte* first, std::size_t stride, const StampFormat& format, std::span<std::int64_t> out,
                 const Places& where) {
  if (const auto whole = whole_stamps(format))
    read_whole_stamps(first, stride, format, *whole, out, where);
  else
    read_real_stamps(first, stride, format, out, where);
}

}  // namespace libchar
