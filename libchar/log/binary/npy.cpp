// The .npy format: 1-D, 2-D (rows × channels, C or Fortran order) and structured arrays of plain numbers.

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/refusal.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/binary/rows.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/write/writers.hpp"

namespace libchar {
namespace {

std::uint64_t product(std::uint64_t a, std::uint64_t b, const std::string& file) {
  std::uint64_t result = 0;
  // Half of the range is left for sums with offsets.
  if (__builtin_mul_overflow(a, b, &result) || result > (std::uint64_t{1} << 62U))
    throw input_error("E0408", file + " (field shape)").says("the shape times the size of a value overflows");
  return result;
}

/// The array with its longest dimension in front, as one would write it.
std::string turned(const NpyHeader& header) {
  const auto longest = std::max_element(header.shape.begin(), header.shape.end()) - header.shape.begin();
  return header.shape.size() == 2 ? "array.T" : fmt::format("numpy.moveaxis(array, {}, 0)", longest);
}

std::uint64_t columns_of(const NpyHeader& header, const std::string& file) {
  const std::string where = file + " (field shape)";
  const std::size_t dimensions = header.shape.size();
  if (dimensions == 0) throw input_error("E0408", where).says("is a single number (0-dimensional), not a log");
  if (header.structured && dimensions != 1)
    throw input_error("E0408", where).says("a structured array must have one dimension");
  if (header.structured) return 1;
  if (dimensions == 1) return header.fields[0].count;
  std::uint64_t columns = 1;  // dimensions behind the first are columns
  for (std::size_t d = 1; d < dimensions; ++d) columns = product(columns, header.shape[d], file);
  if (columns == 0) throw input_error("E0408", where).says("has no columns");
  if (columns > kMaxColumns)
    throw input_error("E0408", where)
        .says("has {} columns, more than the limit of {}", columns, kMaxColumns)
        .hint("are rows and columns exchanged? save {}", turned(header));
  return columns;
}

void check_size(const NpyHeader& header, std::uint64_t values, std::uint64_t needed, std::uint64_t file_bytes,
                const std::string& file, Findings& warnings) {
  const std::uint64_t present = file_bytes - header.data_byte;
  if (present < needed) {
    const std::uint64_t item = header.item_bytes;
    throw input_error("E0410", fmt::format("{} (byte {})", file, file_bytes))
        .says("is truncated: {} of {} {} present", present / item, values, header.structured ? "records" : "values")
        .hint("copy it again, or cut the shape to what is there");
  }
  if (present > needed)
    warnings.add("trailing_bytes", "bytes after the array were left out",
                 fmt::format("byte {}", header.data_byte + needed), present - needed);
}

// Columns of a structured array: field by field, a sub-array as NAME_0, NAME_1…
void add_fields(const NpyHeader& header, BinaryLayout& layout) {
  for (const NpyField& field : header.fields) {
    for (std::uint64_t k = 0; k < field.count; ++k) {
      BinaryColumn column;
      column.name = field.array ? fmt::format("{}_{}", field.name, k) : field.name;
      column.number = field.number;
      column.first_byte = header.data_byte + field.byte + k * size_of(field.number.type);
      column.stride = header.item_bytes;
      layout.columns.push_back(std::move(column));
    }
  }
  layout.named = true;
}

/// Of column c, counted with the last dimension the fastest, the place among those of Fortran order.
std::uint64_t fortran_place(const NpyHeader& header, std::uint64_t c) {
  std::uint64_t place = 0;
  for (std::size_t d = header.shape.size() - 1, at = 1; at <= d; ++at) {
    std::uint64_t behind = 1, before = 1;
    for (std::size_t k = at + 1; k <= d; ++k) behind *= header.shape[k];
    for (std::size_t k = 1; k < at; ++k) before *= header.shape[k];
    place += c / behind % header.shape[at] * before;
  }
  return place;
}

void add_plain_columns(const NpyHeader& header, std::uint64_t columns, BinaryLayout& layout) {
  const std::uint64_t item = header.item_bytes;
  layout.column_major = header.fortran_order && columns > 1;
  for (std::uint64_t c = 0; c < columns; ++c) {
    BinaryColumn column;
    column.name = fmt::format("c{}", c);
    column.number = header.fields[0].number;
    column.first_byte = header.data_byte + item * (layout.column_major ? fortran_place(header, c) * layout.rows : c);
    column.stride = layout.column_major ? item : item * columns;
    layout.columns.push_back(std::move(column));
  }
}

std::string describe(const NpyHeader& header, std::uint64_t columns) {
  if (header.structured)
    return fmt::format("structured array of {} records of {} bytes", header.shape[0], header.item_bytes);
  const NumberFormat number = header.fields[0].number;
  const std::string order = size_of(number.type) == 1 ? "" : number.big_endian ? ", big endian" : ", little endian";
  return fmt::format("{} × {} array of {}{}{}", header.shape[0], columns, name_of(number.type), order,
                     header.fortran_order ? ", Fortran order" : "");
}

std::unique_ptr<RowSource> open_npy(const std::string& path, const ReadOptions& options) {
  auto file = std::make_unique<BinaryFile>(path);
  const NpyHeader header = parse_npy_header(file->head(12 + kMaxNpyHeader), file->size(), path);
  const std::uint64_t columns = columns_of(header, path);
  BinaryLayout layout;
  layout.rows = header.shape[0];
  layout.data_byte = header.data_byte;
  const std::uint64_t values = product(layout.rows, columns, path);
  layout.data_bytes = product(values, header.item_bytes, path);
  check_size(header, values, layout.data_bytes, file->size(), path, layout.warnings);
  if (header.structured)
    add_fields(header, layout);
  else
    add_plain_columns(header, columns, layout);
  if (!header.structured && columns > 64 && layout.rows <= 64)
    layout.warnings.add("looks_transposed",
                        fmt::format("{} rows × {} columns: are rows and channels exchanged? save {}", layout.rows,
                                    columns, turned(header)));
  LogInfo info;
  info.format = "npy";
  info.dialect = {fmt::format(".npy version {}", header.major), describe(header, columns)};
  return open_binary_rows(std::move(file), std::move(layout), std::move(info), options);
}

bool sniff_npy(const std::string&, std::string_view first_bytes) { return first_bytes.starts_with("\x93NUMPY"); }

}  // namespace

Format npy_format() {
  Format row;
  row.about.name = "npy";
  row.about.title = "NumPy";
  row.about.suffixes = {".npy"};
  row.about.names = "structured arrays";
  row.about.units = "no";
  row.about.rows_at_places = true;
  row.about.rate = "by a time field";
  row.about.start = "by a time field";
  row.about.written_suffixes = {".npy"};
  row.about.writes_names = false;
  row.sniff = sniff_npy;
  row.open = open_npy;
  row.write = write_npy;
  return row;
}

}  // namespace libchar
