// The raw format: numbers of one type without a header, interleaved or planar, described by a sidecar.

#include <fmt/format.h>

#include "libchar/core/refusal.hpp"
#include "libchar/log/binary/rows.hpp"
#include "libchar/log/binary/sidecar.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/write/writers.hpp"

namespace libchar {
namespace {

// Rows that the file holds; what does not make a whole row is counted.
std::uint64_t count_rows(const Sidecar& sidecar, const BinaryFile& file, Findings& warnings) {
  const std::string& path = file.path();
  if (sidecar.offset > file.size())
    throw input_error("E0422", fmt::format("{} (byte {})", path, file.size()))
        .says("the offset of {} bytes lies after the end of the file ({} bytes)", sidecar.offset, file.size());
  const std::uint64_t present = file.size() - sidecar.offset;
  const std::uint64_t record = sidecar.channels.size() * size_of(sidecar.number.type);
  const std::uint64_t whole = present / record;
  if (present == 0) throw input_error("E0322", path).says("holds no samples");
  if (whole == 0)
    throw input_error("E0422", fmt::format("{} (byte {})", path, file.size()))
        .says("{} bytes are less than one row of {}", present, record);
  const std::uint64_t rows = sidecar.rows.value_or(whole);
  std::uint64_t needed = 0;
  if (__builtin_mul_overflow(rows, record, &needed) || needed > (std::uint64_t{1} << 62U))
    throw input_error("E0422", path).says("rows × channels × bytes overflows: {} × {}", rows, record);
  if (rows > whole)
    throw input_error("E0422", fmt::format("{} (byte {})", path, file.size()))
        .says("is truncated: {} of {} rows present", whole, rows)
        .hint("copy it again, or correct the sidecar's rows");
  if (!sidecar.rows && sidecar.planar && present % record != 0)
    throw input_error("E0422", path)
        .says("{} bytes are not a whole number of rows of {} bytes, so the planes cannot be found", present, record)
        .hint("give rows in the sidecar");
  if (present > needed)
    warnings.add("trailing_bytes", "bytes after the last row were left out",
                 fmt::format("byte {}", sidecar.offset + needed), present - needed);
  return rows;
}

std::unique_ptr<RowSource> open_raw(const std::string& path, const ReadOptions& options) {
  auto file = std::make_unique<BinaryFile>(path);
  const std::string beside = find_sidecar(path);
  if (beside.empty() && file->size() == 0) throw input_error("E0422", path).says("is empty and has no sidecar");
  if (beside.empty())
    throw input_error("E0422", path)
        .says("is raw binary and has no sidecar that says what it holds")
        .hint("write {}.json, such as {}", path, minimal_sidecar());
  const Sidecar sidecar = read_sidecar(beside);
  BinaryLayout layout;
  layout.rows = count_rows(sidecar, *file, layout.warnings);
  layout.data_byte = sidecar.offset;
  layout.named = sidecar.named;
  layout.column_major = sidecar.planar;
  const std::uint64_t item = size_of(sidecar.number.type);
  const std::uint64_t columns = sidecar.channels.size();
  layout.data_bytes = layout.rows * columns * item;
  for (std::uint64_t c = 0; c < columns; ++c) {
    const SidecarChannel& channel = sidecar.channels[static_cast<std::size_t>(c)];
    BinaryColumn column{channel.name, channel.unit, sidecar.number, 0, 0, channel.scale, channel.offset};
    column.first_byte = sidecar.offset + item * (layout.column_major ? c * layout.rows : c);
    column.stride = layout.column_major ? item : item * columns;
    layout.columns.push_back(std::move(column));
  }
  LogInfo info;
  info.format = "raw";
  info.time.rate_hz = sidecar.rate_hz;
  info.time.start_ns = sidecar.t0_ns;
  info.dialect = {"sidecar " + beside,
                  fmt::format("{}, {} endian, {}, {} bytes before the first row", name_of(sidecar.number.type),
                              sidecar.number.big_endian ? "big" : "little", sidecar.planar ? "planar" : "interleaved",
                              sidecar.offset)};
  return open_binary_rows(std::move(file), std::move(layout), std::move(info), options);
}

// Whatever stands beside a sidecar.
bool sniff_raw(const std::string& path, std::string_view) { return !find_sidecar(path).empty(); }

}  // namespace

Format raw_format() {
  Format row;
  row.about.name = "raw";
  row.about.title = "raw binary + sidecar";
  row.about.brief = "raw with sidecar";
  row.about.suffixes = {".f64", ".f32", ".i16", ".i32", ".i8", ".i64", ".u8", ".u16", ".u32", ".u64", ".bin", ".raw"};
  row.about.otherwise = "any with a sidecar";
  row.about.rows_at_places = true;
  row.about.rate = "yes";
  row.about.written_suffixes = {".f64", ".f32", ".bin", ".raw"};
  row.about.writes_rate = true;
  row.sniff = sniff_raw;
  row.open = open_raw;
  row.write = write_raw;
  return row;
}

}  // namespace libchar
