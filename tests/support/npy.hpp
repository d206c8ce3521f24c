#pragma once
// Just enough of the NumPy format to read the recordings of the known answers: little-endian
// doubles, C order or Fortran's.

#include <cstddef>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/shared.hpp"

namespace test {

struct Array {
  std::size_t rows = 0, columns = 1;
  std::vector<double> values;  ///< row by row
  std::vector<double> column(std::size_t c) const {
    std::vector<double> out(rows);
    for (std::size_t r = 0; r < rows; ++r) out[r] = values[r * columns + c];
    return out;
  }
};

inline Array npy(const std::filesystem::path& path) {
  const std::string bytes = slurp(path);
  if (bytes.substr(0, 6) != "\x93NUMPY" || bytes[6] != 1) throw std::runtime_error("not npy 1.0");
  const std::size_t length =
      static_cast<unsigned char>(bytes[8]) + 256U * static_cast<std::size_t>(static_cast<unsigned char>(bytes[9]));
  const std::string header = bytes.substr(10, length);
  if (header.find("'<f8'") == std::string::npos) throw std::runtime_error("not little-endian doubles: " + header);
  Array array;
  const std::string shape = header.substr(header.find('(') + 1);
  std::size_t used = 0;
  array.rows = std::stoul(shape, &used);
  const std::string rest = shape.substr(used + 1, shape.find(')') - used - 1);
  if (rest.find_first_of("0123456789") != std::string::npos) array.columns = std::stoul(rest);
  array.values.resize(array.rows * array.columns);
  std::memcpy(array.values.data(), bytes.data() + 10 + length, array.values.size() * sizeof(double));
  if (header.find("'fortran_order': True") != std::string::npos) {
    const std::vector<double> by_column = array.values;
    for (std::size_t r = 0; r < array.rows; ++r)
      for (std::size_t c = 0; c < array.columns; ++c)
        array.values[r * array.columns + c] = by_column[c * array.rows + r];
  }
  return array;
}

}  // namespace test
