// HDF5 files, read by the HDF5 library in a process of its own: crafted files crash it, and it
// follows names of other files unless told not to.

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/arrays/array_tables.hpp"
#include "libchar/log/arrays/child_process.hpp"
#include "libchar/log/arrays/hdf5_worker.hpp"
#include "libchar/log/binary/file.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kMostListing = std::uint64_t{64} << 20U;
constexpr std::string_view kHdf5Magic("\x89HDF\r\n\x1a\n", 8);

class Hdf5File final : public ArrayContainer {
 public:
  Hdf5File(const std::string& path, std::string kind)
      : file_(path), kind_(std::move(kind)), child_(answering_hdf5, path) {
    const std::string bytes = next_answer(path, kMostListing);
    if (!decode(bytes, listing_)) throw input_error("E0465", path).says("its listing makes no sense");
    if (!listing_.refusal.empty()) throw input_error("E0465", path).says(listing_.refusal).hint("copy the file again");
  }

  const std::vector<LogArray>& arrays() const override { return listing_.arrays; }
  std::vector<SaidNumber> said() const override { return listing_.said; }
  std::uint64_t bytes_read() const override { return std::min(consumed_, file_.size()); }

  std::vector<std::string> dialect() const override {
    std::vector<std::string> words = {fmt::format("{}, {}", kind_, plural(listing_.arrays.size(), "array"))};
    for (std::size_t i = 0; i < std::min<std::size_t>(listing_.left_out.size(), 4); ++i)
      words.push_back("left out: " + printable(listing_.left_out[i]));
    return words;
  }

  std::unique_ptr<ArrayCursor> open(std::size_t array, const ArrayRows& rows,
                                    const std::vector<std::uint64_t>& columns) override;

  /// The elements that answer a question.
  std::vector<std::byte> elements(const Hdf5Question& question, std::uint64_t expected) {
    const LogArray& array = listing_.arrays[detail::in_memory(question.array)];
    const std::string where = fmt::format("{}, {}{}{} (row {})", file_.path(), printable(array.group),
                                          array.group.empty() ? "" : "/", printable(array.name), question.row);
    try {
      child_.ask(std::as_bytes(std::span(&question, 1)));
    } catch (const ChildGone& gone) {
      throw input_error("E0465", where).says("the HDF5 library {}", gone.why);
    }
    const std::string bytes = next_answer(where, expected);
    if (bytes.size() != expected)
      throw input_error("E0465", where).says("the HDF5 library gave another number of bytes");
    consumed_ += expected;
    const auto span = std::as_bytes(std::span(bytes));
    return {span.begin(), span.end()};
  }

 private:
  std::string next_answer(const std::string& where, std::uint64_t most) {
    try {
      std::uint64_t size = 0;
      child_.answer(std::as_writable_bytes(std::span(&size, 1)));
      if (size == ~std::uint64_t{0})
        throw input_error("E0465", where)
            .says("the HDF5 library cannot read it: it is cut or damaged")
            .hint("copy the file again");
      if (size > most) throw input_error("E0465", where).says("the HDF5 library says too much of it");
      std::string bytes(static_cast<std::size_t>(size), '\0');
      child_.answer(std::as_writable_bytes(std::span(bytes)));
      return bytes;
    } catch (const ChildGone& gone) {
      throw input_error("E0465", where).says("the HDF5 library {} on this file", gone.why);
    }
  }

  BinaryFile file_;
  std::string kind_;
  ChildProcess child_;
  Hdf5Listing listing_;
  std::uint64_t consumed_ = 0;
};

class Hdf5Cursor final : public ArrayCursor {
 public:
  Hdf5Cursor(Hdf5File& file, std::size_t array, const ArrayRows& rows, std::vector<std::uint64_t> columns)
      : file_(file), array_(array), rows_(rows), columns_(std::move(columns)) {
    blocks_.resize(rows_.planar ? columns_.size() : 1);
  }

  void next(std::size_t rows, std::vector<ArrayPiece>& pieces) override {
    const auto element = static_cast<std::size_t>(file_.arrays()[detail::in_memory(array_)].element_bytes);
    pieces.clear();
    Hdf5Question question{array_, row_, rows, 0, rows_.planar ? 1U : 0U};
    if (!rows_.planar) blocks_[0] = file_.elements(question, rows * rows_.columns * element);
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      question.column = columns_[i];
      if (rows_.planar) blocks_[i] = file_.elements(question, rows * element);
      pieces.push_back(rows_.planar ? ArrayPiece{blocks_[i].data(), element}
                                    : ArrayPiece{blocks_[0].data() + columns_[i] * element,
                                                 static_cast<std::size_t>(rows_.columns) * element});
    }
    row_ += rows;
  }

 private:
  Hdf5File& file_;
  std::uint64_t array_, row_ = 0;
  ArrayRows rows_;
  std::vector<std::uint64_t> columns_;
  std::vector<std::vector<std::byte>> blocks_;
};

std::unique_ptr<ArrayCursor> Hdf5File::open(std::size_t array, const ArrayRows& rows,
                                            const std::vector<std::uint64_t>& columns) {
  return std::make_unique<Hdf5Cursor>(*this, array, rows, columns);
}

}  // namespace

std::unique_ptr<ArrayContainer> open_hdf5_file(const std::string& path, const std::string& kind) {
  if (!hdf5_is_here())
    throw input_error("E0467", path)
        .says("is a HDF5 file, and the HDF5 library is not installed, or was not when this program was built")
        .hint("install libhdf5-103-1 (libhdf5-dev to build again), or save the arrays by numpy.savez");
  return std::make_unique<Hdf5File>(path, kind);
}

Format hdf5_format() {
  Format row;
  row.about.name = "hdf5";
  row.about.title = "HDF5";
  row.about.suffixes = {".h5", ".hdf5"};
  row.about.units = "attributes";
  row.about.rate = "by a time dataset, or an attribute";
  row.about.start = "by a time dataset";
  row.about.topics = true;
  row.certain = [](std::string_view first_bytes) { return first_bytes.starts_with(kHdf5Magic); };
  row.topics = [](const std::string& path, const ReadOptions&) {
    return array_tables(open_hdf5_file(path, "HDF5"), path);
  };
  return row;
}

}  // namespace libchar
