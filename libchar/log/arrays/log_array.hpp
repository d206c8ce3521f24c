#pragma once
// The contract of containers of named arrays (.npz, MATLAB, HDF5): a container lists its arrays and
// reads rows of one. What makes tables of them is common (array_tables.hpp).

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "libchar/log/binary/number_type.hpp"

namespace libchar {

/// A number, or several side by side, of one element of an array.
struct ElementField {
  std::string name;  ///< "" in an array of plain numbers
  std::string unit;
  NumberFormat number;
  std::uint64_t byte = 0;   ///< within the element
  std::uint64_t count = 1;  ///< numbers side by side
  bool array = false;       ///< declared with a shape: its columns are called NAME_0, NAME_1…
  bool real = false;        ///< no count, though it may be stored as an integer
};

/// A number that stands beside arrays, such as fs = 200.
struct SaidNumber {
  std::string group;  ///< of all arrays of this group
  std::string name;
  double value = 0;
};

/// One array as its container has it.
struct LogArray {
  std::string group;  ///< where it stands: "" at the top, else "run1/imu"
  std::string name;
  std::vector<ElementField> fields;  ///< one of plain numbers, several of a record
  std::uint64_t element_bytes = 0;
  std::vector<std::uint64_t> shape;   ///< () is a single number
  bool first_fastest = false;         ///< Fortran order: neighbours along the first dimension stand side by side
  std::vector<SaidNumber> said;       ///< numbers beside it (attributes), one of which may be a rate
  std::string why_not;                ///< why it holds no numbers that can be read ("is text"); "" when it does
  std::vector<std::string> left_out;  ///< fields of a record that hold none, in words ("label is text")
};

/// How the elements of an array are rows and columns.
struct ArrayRows {
  std::uint64_t rows = 0, columns = 0;
  bool planar = false;  ///< a column after the other, else a row after the other
  bool turned = false;  ///< rows run along the second dimension
};

/// Elements of a column in memory.
struct ArrayPiece {
  const std::byte* first = nullptr;
  std::size_t stride = 0;  ///< bytes from one to the next
};

/// Goes once through the rows of some columns.
class ArrayCursor {
 public:
  virtual ~ArrayCursor() = default;
  /// The next `rows` elements of every column that was asked for; never more in all than there are.
  /// Pieces hold until the next call.
  virtual void next(std::size_t rows, std::vector<ArrayPiece>& pieces) = 0;
};

class ArrayContainer {
 public:
  virtual ~ArrayContainer() = default;
  virtual const std::vector<LogArray>& arrays() const = 0;
  /// Numbers beside whole groups (attributes).
  virtual std::vector<SaidNumber> said() const { return {}; }
  /// What was understood of the file, in words.
  virtual std::vector<std::string> dialect() const = 0;
  /// `columns` rise; the container outlives the cursor. Throws Error(input) for what is found broken.
  virtual std::unique_ptr<ArrayCursor> open(std::size_t array, const ArrayRows& rows,
                                            const std::vector<std::uint64_t>& columns) = 0;
  /// Bytes of the file consumed so far, for progress.
  virtual std::uint64_t bytes_read() const = 0;
};

}  // namespace libchar
