// The listing of a HDF5 file as bytes, from the child that made it to its parent, which trusts none of them.

#include <cstring>
#include <string_view>

#include "libchar/log/arrays/hdf5_worker.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kMostItems = 200000;

struct Encoder {
  std::string out;
  void number(std::uint64_t value) {
    char bytes[8];
    std::memcpy(bytes, &value, sizeof bytes);
    out.append(bytes, sizeof bytes);
  }
  void real(double value) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    number(bits);
  }
  void text(const std::string& value) {
    number(value.size());
    out += value;
  }
};

class Decoder {
 public:
  explicit Decoder(std::string_view bytes) : bytes_(bytes) {}
  bool good() const { return good_; }
  bool at_end() const { return at_ == bytes_.size(); }
  std::uint64_t number() {
    std::uint64_t value = 0;
    if (bytes_.size() - at_ < sizeof value) return fail();
    std::memcpy(&value, bytes_.data() + at_, sizeof value);
    at_ += sizeof value;
    return value;
  }
  std::uint64_t count() {
    const std::uint64_t value = number();
    return value > kMostItems ? fail() : value;
  }
  double real() {
    const std::uint64_t bits = number();
    double value = 0;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  }
  std::string text() {
    const std::uint64_t size = number();
    if (size > bytes_.size() - at_) {
      fail();
      return "";
    }
    std::string value(bytes_.substr(at_, static_cast<std::size_t>(size)));
    at_ += static_cast<std::size_t>(size);
    return value;
  }

 private:
  std::uint64_t fail() {
    good_ = false;
    at_ = bytes_.size();
    return 0;
  }
  std::string_view bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

void encode_numbers(Encoder& to, const std::vector<SaidNumber>& numbers) {
  to.number(numbers.size());
  for (const SaidNumber& number : numbers) {
    to.text(number.group);
    to.text(number.name);
    to.real(number.value);
  }
}

std::vector<SaidNumber> decode_numbers(Decoder& from) {
  std::vector<SaidNumber> numbers;
  for (std::uint64_t n = from.count(); n > 0 && from.good(); --n) {
    SaidNumber number;
    number.group = from.text();
    number.name = from.text();
    number.value = from.real();
    numbers.push_back(std::move(number));
  }
  return numbers;
}

void encode_texts(Encoder& to, const std::vector<std::string>& texts) {
  to.number(texts.size());
  for (const std::string& text : texts) to.text(text);
}

std::vector<std::string> decode_texts(Decoder& from) {
  std::vector<std::string> texts;
  for (std::uint64_t n = from.count(); n > 0 && from.good(); --n) texts.push_back(from.text());
  return texts;
}

void encode_array(Encoder& to, const LogArray& array) {
  to.text(array.group);
  to.text(array.name);
  to.text(array.why_not);
  to.number(array.element_bytes);
  to.number(array.first_fastest ? 1 : 0);
  to.number(array.shape.size());
  for (const std::uint64_t extent : array.shape) to.number(extent);
  to.number(array.fields.size());
  for (const ElementField& field : array.fields) {
    to.text(field.name);
    to.text(field.unit);
    to.number(static_cast<std::uint64_t>(field.number.type));
    to.number(field.byte);
    to.number(field.count);
    to.number(field.array ? 1 : 0);
  }
  encode_numbers(to, array.said);
  encode_texts(to, array.left_out);
}

LogArray decode_array(Decoder& from) {
  LogArray array;
  array.group = from.text();
  array.name = from.text();
  array.why_not = from.text();
  array.element_bytes = from.number();
  array.first_fastest = from.number() != 0;
  for (std::uint64_t n = from.count(); n > 0 && from.good(); --n) array.shape.push_back(from.number());
  for (std::uint64_t n = from.count(); n > 0 && from.good(); --n) {
    ElementField field;
    field.name = from.text();
    field.unit = from.text();
    field.number.type = static_cast<NumberType>(from.number() % kNumberTypes);
    field.byte = from.number();
    field.count = from.count();
    field.array = from.number() != 0;
    array.fields.push_back(std::move(field));
  }
  array.said = decode_numbers(from);
  array.left_out = decode_texts(from);
  return array;
}

// Nothing that is read later may reach behind an element.
bool holds(const LogArray& array) {
  if (!array.why_not.empty()) return true;
  for (const ElementField& field : array.fields) {
    const std::uint64_t bytes = field.count * size_of(field.number.type);
    if (field.count == 0 || field.byte > array.element_bytes || bytes > array.element_bytes - field.byte) return false;
  }
  return !array.fields.empty() && array.element_bytes <= (1U << 20U);
}

}  // namespace

std::string encode(const Hdf5Listing& listing) {
  Encoder to;
  to.text(listing.refusal);
  to.number(listing.arrays.size());
  for (const LogArray& array : listing.arrays) encode_array(to, array);
  encode_numbers(to, listing.said);
  encode_texts(to, listing.left_out);
  return std::move(to.out);
}

bool decode(std::string_view bytes, Hdf5Listing& listing) {
  Decoder from(bytes);
  listing.refusal = from.text();
  for (std::uint64_t n = from.count(); n > 0 && from.good(); --n) {
    listing.arrays.push_back(decode_array(from));
    if (!holds(listing.arrays.back())) return false;
  }
  listing.said = decode_numbers(from);
  listing.left_out = decode_texts(from);
  return from.good() && from.at_end();
}

}  // namespace libchar
