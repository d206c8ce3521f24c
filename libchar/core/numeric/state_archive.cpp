#include "libchar/core/numeric/state_archive.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "libchar/core/file/sha256.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"

namespace libchar {
namespace {

constexpr std::string_view kMagic{"\x89LCSTAT\n", 8};  // no text begins like this
constexpr std::size_t kLengthAt = 12, kHead = 20, kDigest = 64;

// Sign and kind of a long double in front of its mantissa and exponent.
enum Wide : unsigned char { positive = 0, negative = 1, infinite = 2, not_a_number = 4 };

std::string little(std::uint64_t value, std::size_t bytes) {
  std::string out(bytes, '\0');
  for (std::size_t i = 0; i < bytes; ++i) out[i] = static_cast<char>(value >> (8 * i) & 0xFFU);
  return out;
}

std::uint64_t little(std::string_view bytes) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    value |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[i])) << (8 * i);
  return value;
}

std::string digest_of(std::string_view bytes) {
  Sha256 digest;
  digest.update(bytes);
  return digest.finish();
}

const char* const kAgain = "make it again, or copy it again";

}  // namespace

StateWriter::StateWriter(std::string_view kind, std::uint32_t version)
    : bytes_(std::string(kMagic) + little(version, 4) + little(0, 8)) {
  text(kind);
}

void StateWriter::number(std::uint64_t value) { bytes_ += little(value, 8); }

// mantissa * 2^exponent with a mantissa of 64 bits: exact for every format of at most as many. Of 113, as a web page
// has them, these are the first.
void StateWriter::wide(long double value) {
  unsigned char kind = std::signbit(value) ? negative : positive;
  int exponent = 0;
  std::uint64_t mantissa = 0;
  if (std::isnan(value)) {
    kind = not_a_number;
  } else if (std::isinf(value)) {
    kind |= infinite;
  } else {
    const long double fraction = std::frexp(std::fabs(value), &exponent);
    mantissa = static_cast<std::uint64_t>(std::ldexp(fraction, 64));
  }
  bytes_ += static_cast<char>(kind);
  number(mantissa);
  number(static_cast<std::uint64_t>(static_cast<std::int64_t>(exponent)));
}

void StateWriter::text(std::string_view value) {
  number(value.size());
  bytes_ += value;
}

void StateWriter::texts(std::span<const std::string> values) {
  number(values.size());
  for (const std::string& value : values) text(value);
}

void StateWriter::reals(std::span<const double> values) {
  number(values.size());
  if constexpr (std::endian::native == std::endian::little)
    bytes_.append(reinterpret_cast<const char*>(values.data()), values.size_bytes());
  else
    for (const double value : values) real(value);
}

void StateWriter::numbers(std::span<const std::uint64_t> values) {
  number(values.size());
  for (const std::uint64_t value : values) number(value);
}

void StateWriter::flags(std::span<const unsigned char> values) {
  number(values.size());
  for (const unsigned char value : values) flag(value != 0);
}

std::string StateWriter::finish() {
  bytes_.replace(kLengthAt, 8, little(bytes_.size() - kHead, 8));
  bytes_ += digest_of(bytes_);
  return std::move(bytes_);
}

StateReader::StateReader(std::string_view bytes, std::string name, std::string_view kind, std::uint32_t version)
    : name_(std::move(name)) {
  if (!bytes.starts_with(kMagic))
    throw input_error("E0723", name_).says(bytes.empty() ? "is empty" : "is not a partial state").hint(kAgain);
  if (bytes.size() < kHead + kDigest)
    throw input_error("E0723", name_).says("is cut: {} bytes", bytes.size()).hint(kAgain);
  const std::uint64_t found = little(bytes.substr(kMagic.size(), 4));
  const std::uint64_t length = little(bytes.substr(kLengthAt, 8));
  const std::uint64_t present = bytes.size() - kHead - kDigest;
  const bool whole =
      length == present && digest_of(bytes.substr(0, bytes.size() - kDigest)) == bytes.substr(bytes.size() - kDigest);
  if (!whole && length > present)
    throw input_error("E0723", name_).says("is cut: {} bytes of its content of {}", present, length).hint(kAgain);
  if (!whole) throw input_error("E0723", name_).says("is damaged: its digest is another one").hint(kAgain);
  rest_ = bytes.substr(kHead, detail::in_memory(length));
  if (const std::string is = text(); is != kind)
    throw input_error("E0723", name_).says("is a state of {}, not of {}", is, kind);
  if (found != version)
    throw input_error("E0723", name_)
        .says("is of version {}; this program reads version {}", found, version)
        .hint("use one version of the program on all machines");
}

std::string_view StateReader::take(std::size_t bytes) {
  if (bytes > rest_.size()) refuse("it ends within a value");
  const std::string_view out = rest_.substr(0, bytes);
  rest_.remove_prefix(bytes);
  return out;
}

void StateReader::refuse(std::string_view what) const {
  throw input_error("E0723", name_).says("contradicts itself: {}", what).hint(kAgain);
}

void StateReader::finish() const {
  if (!rest_.empty()) refuse("it holds more than was expected");
}

std::uint64_t StateReader::number() { return little(take(8)); }

long double StateReader::wide() {
  const auto kind = static_cast<unsigned char>(take(1)[0]);
  const std::uint64_t mantissa = number();
  const auto exponent = static_cast<std::int64_t>(number());
  if (kind == not_a_number) return std::numeric_limits<long double>::quiet_NaN();
  if (kind > (infinite | negative) || exponent < -20000 || exponent > 20000) refuse("a wide number");
  const long double size = (kind & infinite) != 0
                               ? std::numeric_limits<long double>::infinity()
                               : std::ldexp(static_cast<long double>(mantissa), static_cast<int>(exponent) - 64);
  return (kind & negative) != 0 ? -size : size;
}

bool StateReader::flag() {
  const char value = take(1)[0];
  if (value != 0 && value != 1) refuse("a flag");
  return value == 1;
}

std::size_t StateReader::count(std::size_t least) {
  const std::uint64_t count = number();
  if (count > rest_.size() / least) refuse("a list is longer than what follows");
  return static_cast<std::size_t>(count);
}

std::string StateReader::text() { return std::string(take(count(1))); }

std::vector<std::string> StateReader::texts() {
  std::vector<std::string> out(count(8));
  for (std::string& value : out) value = text();
  return out;
}

std::vector<double> StateReader::reals() {
  std::vector<double> out(count(8));
  for (double& value : out) value = real();
  return out;
}

std::vector<std::uint64_t> StateReader::numbers() {
  std::vector<std::uint64_t> out(count(8));
  for (std::uint64_t& value : out) value = number();
  return out;
}

std::vector<unsigned char> StateReader::flags() {
  std::vector<unsigned char> out(count(1));
  for (unsigned char& value : out) value = flag() ? 1 : 0;
  return out;
}

}  // namespace libchar
