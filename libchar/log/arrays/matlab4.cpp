// MATLAB files of version 4 (save -v4, Octave's -mat4-binary, SciPy's format='4') as a container of arrays. Source:
// MathWorks, MAT-File Format (R2023b), chapter 1: of each matrix five numbers of 32 bits (how it is stored, rows,
// columns, whether an imaginary part follows, length of the name), its name and its elements by columns.
#include "libchar/log/arrays/matlab4.hpp"

#include <fmt/format.h>

#include <array>
#include <cstring>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/arrays/packed_array.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {
namespace {

constexpr std::size_t kHeadNumbers = 5, kHead4Bytes = 4 * kHeadNumbers, kMostNameBytes = 1024;

struct Head4 {
  std::uint32_t number = 0, kind = 0, rows = 0, columns = 0, imaginary = 0, name_bytes = 0;
  bool big_endian = false;
};

/// Nothing where these bytes begin no matrix.
std::optional<Head4> head4_of(std::string_view bytes) {
  if (bytes.size() < kHead4Bytes) return std::nullopt;
  for (const bool big : {false, true}) {
    std::array<std::uint32_t, kHeadNumbers> raw{};
    std::memcpy(raw.data(), bytes.data(), kHead4Bytes);
    if (big)
      for (std::uint32_t& value : raw) value = __builtin_bswap32(value);
    const std::uint32_t type = raw[0], number = type / 10 % 10, kind = type % 10;
    if (type / 1000 != (big ? 1U : 0U) || type / 100 % 10 != 0 || number > 5 || kind > 2) continue;
    if (raw[3] > 1 || raw[4] < 2 || raw[4] > kMostNameBytes) continue;
    return Head4{number, kind, raw[1], raw[2], raw[3], raw[4], big};
  }
  return std::nullopt;
}

std::string why_not_matrix(const Head4& head) {
  if (head.kind == 1) return "is text";
  if (head.kind == 2) return "is sparse; save full(x)";
  if (head.imaginary != 0) return "holds complex numbers";
  return head.rows == 0 || head.columns == 0 ? "is empty" : "";
}

class Matlab4File final : public ArrayContainer {
 public:
  explicit Matlab4File(const std::string& path) : file_(path) {
    for (std::uint64_t at = 0; at < file_.size();) at = add_matrix(at);
  }
  const std::vector<LogArray>& arrays() const override { return arrays_; }
  std::uint64_t bytes_read() const override { return std::min(consumed_, file_.size()); }
  std::vector<std::string> dialect() const override { return {"MATLAB 4, " + plural(arrays_.size(), "array")}; }
  std::unique_ptr<ArrayCursor> open(std::size_t array, const ArrayRows& rows,
                                    const std::vector<std::uint64_t>& columns) override {
    return open_packed_array(file_, places_[array], rows, columns, consumed_);
  }

 private:
  [[noreturn]] void refuse(std::uint64_t byte, std::string what) const {
    throw input_error("E0464", fmt::format("{} (byte {})", file_.path(), byte))
        .says(std::move(what))
        .hint("save it again, or copy it again");
  }

  /// Where the next one begins.
  std::uint64_t add_matrix(std::uint64_t at) {
    PackedBytes bytes(file_, {at, file_.size() - at, file_.size() - at, Packing::stored}, "matrix");
    std::string front(detail::in_memory(std::min<std::uint64_t>(kHead4Bytes, file_.size() - at)), '\0');
    bytes.read(std::as_writable_bytes(std::span(front)));
    const auto head = head4_of(front);
    if (!head) refuse(at, "holds no matrix of MATLAB 4 here: it is cut or damaged");
    static constexpr std::array kNumbers = {NumberType::f64, NumberType::f32, NumberType::i32,
                                            NumberType::i16, NumberType::u16, NumberType::u8};
    const std::uint64_t each = size_of(kNumbers[head->number]), data = at + kHead4Bytes + head->name_bytes;
    std::uint64_t size = each * (1 + head->imaginary);
    const bool huge = __builtin_mul_overflow(size, std::uint64_t{head->rows}, &size) ||
                      __builtin_mul_overflow(size, std::uint64_t{head->columns}, &size);
    if (huge || data > file_.size() || size > file_.size() - data)
      refuse(at, "has a matrix that is longer than the file: it is cut or damaged");
    std::string name(head->name_bytes, '\0');
    bytes.read(std::as_writable_bytes(std::span(name)));
    LogArray& array = arrays_.emplace_back();
    array.name = name.substr(0, name.find('\0'));
    array.why_not = why_not_matrix(*head);
    array.shape = {head->rows, head->columns};
    array.first_fastest = true;
    // Whole doubles may be stored as integers.
    array.fields.push_back({"", "", {kNumbers[head->number], head->big_endian}, 0, 1, false, true});
    array.element_bytes = each;
    places_.push_back(
        {{0, file_.size(), data + size, Packing::stored}, printable(array.name), data, each, std::nullopt});
    return data + size;
  }

  BinaryFile file_;
  std::vector<LogArray> arrays_;
  std::vector<PackedArray> places_;  // beside arrays_
  std::uint64_t consumed_ = 0;
};

}  // namespace

bool is_matlab4(std::string_view first_bytes) { return head4_of(first_bytes).has_value(); }

std::unique_ptr<ArrayContainer> open_matlab4_file(const std::string& path) {
  return std::make_unique<Matlab4File>(path);
}

}  // namespace libchar
