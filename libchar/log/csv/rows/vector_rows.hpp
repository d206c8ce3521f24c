#pragma once
// The common case of a CSV body, fast: rows of decimal numbers without exponents, nothing else. Everything
// unusual is left to the general parser, row by row, so that this file decides nothing about damage.

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace libchar {

/// What each column of the body is to become.
struct VectorColumn {
  enum class Use { skip, value, stamp } use = Use::skip;
  double* values = nullptr;        ///< Use::value: destination of row 0
  std::int64_t* stamps = nullptr;  ///< Use::stamp: destination of row 0
  char* fractional = nullptr;      ///< Use::value: set when some value was not written as an integer
  int stamp_digits = 9;            ///< Use::stamp: decimal digits between the stamp's unit and nanoseconds (9
                                   ///< s, 6 ms, 3 us, 0 ns)
};

struct VectorRows {
  std::size_t rows = 0;      ///< whole rows written, from row 0 of the destinations
  std::size_t consumed = 0;  ///< bytes of `text` that they took; the next row begins there
};

inline constexpr std::size_t kVectorPadding = 64;  ///< readable bytes that must follow `text`

/// Parses rows from the start of `text` (which begins at a row and ends with a line feed) until the
/// end, until `max_rows`, or until the first row that is unusual: wrong number of fields, an
/// empty field, a quote, a word, a value that does not fit, another line end than `crlf` says.
/// Looks at no more text than `max_rows` need. Numbers are rounded correctly, the same bits as
/// std::from_chars. `scratch` is reused between calls. On a processor without AVX2 no row is taken.
VectorRows parse_vector_rows(std::string_view text, char delimiter, bool crlf, std::span<const VectorColumn> columns,
                             std::size_t max_rows, std::vector<std::uint32_t>& scratch);

}  // namespace libchar
