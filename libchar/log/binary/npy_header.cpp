#include "libchar/log/binary/npy_header.hpp"

#include <fmt/format.h>

#include <charconv>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/file.hpp"

namespace libchar {
namespace {

// One pass over the literal {'descr': …, 'fortran_order': …, 'shape': …}: its structure is fixed,
// so no recursion is needed.
class Literal {
 public:
  Literal(std::string_view text, std::uint64_t first_byte, const std::string& file)
      : text_(text), first_byte_(first_byte), file_(file) {}

  void read(NpyHeader& header) {
    expect('{');
    bool descr = false, order = false, shape = false;
    while (peek() != '}') {
      const std::size_t at = position_;
      const std::string key = string();
      bool& seen = key == "descr"           ? descr
                   : key == "fortran_order" ? order
                   : key == "shape"         ? shape
                                            : refuse_key(key, at);
      if (seen) throw refusal("E0406", at).says("a key is repeated in the header").got(key);
      seen = true;
      expect(':');
      if (key == "descr")
        read_descr(header);
      else if (key == "shape")
        header.shape = read_shape();
      else
        header.fortran_order = read_bool();
      if (peek() == ',')
        ++position_;
      else if (peek() != '}')
        throw refusal("E0407", position_).says("expected , or } in the header").got(word());
    }
    ++position_;
    skip_blanks();
    if (position_ != text_.size()) throw refusal("E0407", position_).says("text follows the header's }").got(word());
    if (!descr || !order || !shape)
      throw refusal("E0407", 0)
          .says("the header has no key \"{}\"", !descr   ? "descr"
                                                : !order ? "fortran_order"
                                                         : "shape");
  }

 private:
  Refusal refusal(const char* code, std::size_t at, std::string_view field = "") const {
    const std::string name = field.empty() ? "" : ", field " + std::string(field);
    return input_error(code, fmt::format("{} (byte {}{})", file_, first_byte_ + at, name));
  }
  bool& refuse_key(const std::string& key, std::size_t at) const {
    throw refusal("E0406", at)
        .says("unknown key in the header; a .npy header has descr, fortran_order and shape")
        .got(key);
  }

  void skip_blanks() {
    while (position_ < text_.size() && (text_[position_] == ' ' || text_[position_] == '\t' ||
                                        text_[position_] == '\n' || text_[position_] == '\r'))
      ++position_;
  }
  char peek() {
    skip_blanks();
    return position_ < text_.size() ? text_[position_] : '\0';
  }
  std::string_view word() const { return text_.substr(std::min(position_, text_.size()), 40); }
  void expect(char c) {
    if (peek() != c) throw refusal("E0407", position_).says("expected {} in the header", c).got(word());
    ++position_;
  }

  std::string string() {
    const char quote = peek();
    if (quote != '\'' && quote != '"')
      throw refusal("E0407", position_).says("expected a quoted string in the header").got(word());
    std::string value;
    for (++position_; position_ < text_.size() && text_[position_] != quote; ++position_) {
      if (text_[position_] == '\\') {
        const char next = position_ + 1 < text_.size() ? text_[position_ + 1] : '\0';
        if (next != '\\' && next != '\'' && next != '"')
          throw refusal("E0407", position_).says("unsupported escape in a name").got(word());
        ++position_;
      }
      value += text_[position_];
    }
    if (position_ >= text_.size()) throw refusal("E0407", position_).says("a string in the header does not end");
    ++position_;
    return value;
  }

  bool read_bool() {
    const std::size_t at = (skip_blanks(), position_);
    for (const auto& [name, value] : {std::pair{"True", true}, std::pair{"False", false}}) {
      if (text_.substr(position_).starts_with(name)) {
        position_ += std::string_view(name).size();
        return value;
      }
    }
    throw refusal("E0407", at).says("fortran_order is neither True nor False").got(word());
  }

  std::uint64_t number() {
    skip_blanks();
    const std::size_t at = position_;
    std::uint64_t value = 0;
    if (peek() == '-') throw refusal("E0408", at).says("a dimension is negative").got(word());
    const auto [end, status] = std::from_chars(text_.data() + position_, text_.data() + text_.size(), value);
    if (status == std::errc::result_out_of_range)
      throw refusal("E0408", at).says("a dimension is too large").got(word());
    if (status != std::errc()) throw refusal("E0407", at).says("expected a dimension (a whole number)").got(word());
    position_ = static_cast<std::size_t>(end - text_.data());
    if (position_ < text_.size() && text_[position_] == 'L') ++position_;  // Python 2 wrote long integers so
    return value;
  }

  // "(4,)", "(2, 3)", "()"; "(4)" is no tuple.
  std::vector<std::uint64_t> read_shape() {
    const std::size_t at = (skip_blanks(), position_);
    expect('(');
    std::vector<std::uint64_t> shape;
    bool comma = true;
    while (peek() != ')') {
      if (!comma) throw refusal("E0407", position_).says("expected , between dimensions").got(word());
      if (shape.size() == 32) throw refusal("E0408", at).says("the array has more than 32 dimensions");
      shape.push_back(number());
      comma = peek() == ',';
      if (comma) ++position_;
    }
    ++position_;
    if (shape.size() == 1 && !comma)
      throw refusal("E0407", at)
          .says("the shape is not a tuple: one dimension is written (4,)")
          .got(text_.substr(at, position_ - at));
    return shape;
  }

  // "<f8" and its kin; everything that is not a plain number is refused by what it is.
  NumberFormat number_type(const std::string& type, std::size_t at, const std::string& field) const {
    const char order = type.empty() ? '\0' : type[0];
    const bool marked = order == '<' || order == '>' || order == '|' || order == '=';
    const std::string kind = marked ? type.substr(1) : type;
    const auto no = [&](std::string what, std::string hint) {
      throw refusal("E0409", at, field).says(std::move(what)).got(type).hint(std::move(hint));
    };
    switch (kind.empty() ? '\0' : kind[0]) {
      case 'O':
        no("holds Python objects (pickled code), which are never read", "save numbers: array.astype(float)");
        break;
      case 'c':
        no("holds complex numbers", "save real and imaginary parts as two columns");
        break;
      case 'U':
      case 'S':
      case 'a':
        no("holds text, not numbers", "save numbers: array.astype(float)");
        break;
      case 'M':
      case 'm':
        no("holds calendar times", "save them as integers: array.astype('datetime64[ns]').astype('int64')");
        break;
      case 'V':
        no("holds opaque bytes", "save numbers: array.astype(float)");
        break;
      case 'b':
        if (kind == "b1") no("holds truth values, not samples", "save numbers: array.astype('u1')");
        break;
      default:
        break;
    }
    static constexpr std::pair<std::string_view, NumberType> kKinds[] = {
        {"f2", NumberType::f16}, {"f4", NumberType::f32}, {"f8", NumberType::f64}, {"i1", NumberType::i8},
        {"i2", NumberType::i16}, {"i4", NumberType::i32}, {"i8", NumberType::i64}, {"u1", NumberType::u8},
        {"u2", NumberType::u16}, {"u4", NumberType::u32}, {"u8", NumberType::u64}};
    for (const auto& [name, number] : kKinds)
      if (kind == name && (marked || size_of(number) == 1)) return {number, order == '>'};
    no("is of a type that is not read; f2, f4, f8, i1 to i8 and u1 to u8 are",
       kind == "f16" || kind == "f12" ? "save doubles: array.astype('f8')" : "");
    return {};
  }

  void add_field(NpyHeader& header, NpyField field) const {
    std::uint64_t bytes = 0;
    if (__builtin_mul_overflow(field.count, size_of(field.number.type), &bytes) || field.count > kMaxColumns)
      throw refusal("E0408", 0, field.name).says("has more than {} columns", kMaxColumns);
    field.byte = header.item_bytes;
    header.item_bytes += bytes;
    header.fields.push_back(std::move(field));
  }

  void read_descr(NpyHeader& header) {
    if (peek() != '[') {
      const std::size_t at = position_;
      add_field(header, {"", number_type(string(), at, ""), 1, false, 0});
      return;
    }
    header.structured = true;
    read_record(header, "", 0);
    if (header.fields.empty()) throw refusal("E0409", 0).says("the record has no field that holds numbers");
  }

  // Fields of a record within a record have its name in front.
  void read_record(NpyHeader& header, const std::string& front, std::size_t depth) {
    constexpr std::size_t kDeepest = 8;
    if (depth > kDeepest) throw refusal("E0409", position_).says("records lie too deep in each other").got(word());
    ++position_;
    while (peek() != ']') {
      read_field(header, front, depth);
      if (peek() == ',')
        ++position_;
      else if (peek() != ']')
        throw refusal("E0407", position_).says("expected , or ] in descr").got(word());
    }
    ++position_;
  }

  // ('gyr', '<f8', (3,)); the last part is optional.
  void read_field(NpyHeader& header, const std::string& front, std::size_t depth) {
    expect('(');
    if (peek() == '(')
      throw refusal("E0409", position_).says("a field has a title as well as a name, which is not read").got(word());
    NpyField field;
    field.name = string();
    expect(',');
    const std::size_t at = (skip_blanks(), position_);
    if (peek() == '[') {
      read_record(header, front + field.name + ".", depth + 1);
      if (peek() == ',')
        throw refusal("E0409", at, field.name)
            .says("is an array of records, which is not read")
            .got(word())
            .hint("save it flat, one field per channel");
      return expect(')');
    }
    const std::string type = string();
    if (peek() == ',') ++position_;
    if (peek() != ')') {
      field.array = true;
      const std::size_t shape_at = position_;
      const std::vector<std::uint64_t> shape = peek() == '(' ? read_shape() : std::vector<std::uint64_t>{number()};
      for (const std::uint64_t extent : shape)
        if (__builtin_mul_overflow(field.count, extent, &field.count))
          throw refusal("E0408", shape_at, field.name).says("the shape overflows");
    }
    expect(')');
    if (field.name.empty() && type.starts_with("|V")) return skip_padding(header, type, at);
    if (!field.name.empty()) field.name.insert(0, front);
    for (const NpyField& other : header.fields)
      if (other.name == field.name) throw refusal("E0307", at).says("two fields have one name").got(field.name);
    if (field.name.empty()) throw refusal("E0409", at).says("a field has no name").got(type);
    if (field.count == 0) throw refusal("E0408", at, field.name).says("the field holds no number");
    field.number = number_type(type, at, field.name);
    add_field(header, std::move(field));
  }

  // NumPy writes the holes of an aligned record as ('', '|V4').
  void skip_padding(NpyHeader& header, const std::string& type, std::size_t at) const {
    std::uint64_t bytes = 0;
    const auto [end, status] = std::from_chars(type.data() + 2, type.data() + type.size(), bytes);
    if (status != std::errc() || end != type.data() + type.size() || bytes > (1U << 20U))
      throw refusal("E0409", at).says("padding of a senseless size").got(type);
    header.item_bytes += bytes;
  }

  std::string_view text_;
  std::uint64_t first_byte_;
  const std::string& file_;
  std::size_t position_ = 0;
};

void check_magic(std::string_view bytes, const std::string& file) {
  const auto refusal = [&] { return input_error("E0404", file + " (byte 0)").got(bytes.substr(0, 8)); };
  if (bytes.starts_with("PK\x03\x04"))
    throw refusal().says("is a ZIP archive (.npz), not one array").hint("`format` npz reads it");
  constexpr std::string_view kMark = "\x93NUMPY";
  if (!bytes.starts_with(kMark)) throw refusal().says(wrong_start(bytes, kMark, "a .npy file"));
}

}  // namespace

NpyHeader parse_npy_header(std::string_view bytes, std::uint64_t file_bytes, const std::string& file) {
  check_magic(bytes, file);
  const auto refusal = [&](std::size_t byte) { return input_error("E0405", fmt::format("{} (byte {})", file, byte)); };
  if (bytes.size() < 10) throw refusal(bytes.size()).says("ends within its header");
  const auto byte = [&](std::size_t i) { return static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])); };
  NpyHeader header;
  header.major = static_cast<int>(byte(6));
  if (header.major < 1 || header.major > 3)
    throw refusal(6).says("has version {}.{}; versions 1, 2 and 3 are read", byte(6), byte(7));
  std::uint64_t length = byte(8) | byte(9) << 8U;
  std::size_t begin = 10;
  if (header.major >= 2) {
    if (bytes.size() < 12) throw refusal(bytes.size()).says("ends within its header");
    length |= byte(10) << 16U | byte(11) << 24U;
    begin = 12;
  }
  if (length > file_bytes - begin)
    throw refusal(8).says("header length {} exceeds the file size {}", length, file_bytes);
  if (length > kMaxNpyHeader) throw refusal(8).says("header length {} exceeds the limit of {}", length, kMaxNpyHeader);
  std::string literal(bytes.substr(begin, detail::in_memory(length)));
  if (header.major < 3)
    literal = latin1_to_utf8(literal);
  else if (const std::size_t bad = first_invalid_utf8(literal); bad != std::string::npos)
    throw refusal(begin + bad).says("the header is not valid UTF-8");
  Literal(literal, begin, file).read(header);
  header.data_byte = begin + length;
  return header;
}

}  // namespace libchar
