// Sound as a log: RIFF WAVE (Microsoft and IBM, Multimedia Programming Interface 1.0) and RF64 (EBU Tech
// 3306), PCM of 8 to 32 bits and floats. A sample is a share of full scale: value = number / 2^(bits - 1).

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/core/refusal.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/binary/rows.hpp"
#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

constexpr std::uint64_t kUnknownSize = 0xFFFFFFFF;

struct WavHeader {
  std::uint64_t kind = 0, channels = 0, rate_hz = 0, row_bytes = 0, bits = 0;
  std::uint64_t data_byte = 0, data_bytes = 0;
};

Refusal wav_refusal(const BinaryFile& file, std::uint64_t byte) {
  return input_error("E0338", fmt::format("{} (byte {})", file.path(), byte));
}

template <std::size_t n>
std::array<std::byte, n> bytes_at(const BinaryFile& file, std::uint64_t byte) {
  if (byte > file.size() || file.size() - byte < n)
    throw wav_refusal(file, file.size()).says("is cut inside its header");
  std::array<std::byte, n> bytes;
  file.read(byte, bytes);
  return bytes;
}

void read_format(const BinaryFile& file, std::uint64_t byte, std::uint64_t size, WavHeader& header) {
  constexpr std::uint64_t kExtensible = 0xFFFE;
  const auto b = bytes_at<16>(file, byte);
  header.kind = little_endian<2>(b.data());
  header.channels = little_endian<2>(b.data() + 2);
  header.rate_hz = little_endian<4>(b.data() + 4);
  header.row_bytes = little_endian<2>(b.data() + 12);
  header.bits = little_endian<2>(b.data() + 14);
  if (header.kind == kExtensible && size >= 26) header.kind = little_endian<2>(bytes_at<2>(file, byte + 24).data());
}

/// Chunks up to that of the samples: a name of four letters, a size, so many bytes and one more where they are odd.
WavHeader read_header(const BinaryFile& file) {
  const std::string front = file.head(12);
  if (front.size() < 12 || (!front.starts_with("RIFF") && !front.starts_with("RF64")) || !front.ends_with("WAVE"))
    throw wav_refusal(file, 0).says("does not begin like a WAV file");
  WavHeader header;
  std::uint64_t size64 = kUnknownSize;
  for (std::uint64_t at = 12;;) {
    const auto chunk = bytes_at<8>(file, at);
    const std::string name(reinterpret_cast<const char*>(chunk.data()), 4);
    const std::uint64_t size = little_endian<4>(chunk.data() + 4);
    at += 8;
    if (name == "ds64") size64 = little_endian<8>(bytes_at<16>(file, at).data() + 8);
    if (name == "fmt ") read_format(file, at, size, header);
    if (name == "data") {
      header.data_byte = at;
      header.data_bytes = size == kUnknownSize ? size64 : size;
      return header;
    }
    if (size > file.size()) throw wav_refusal(file, at).says("has a chunk of {} bytes", size);
    at += size + size % 2;
  }
}

std::optional<NumberType> number_of(const WavHeader& header) {
  constexpr std::uint64_t kPcm = 1, kFloat = 3;
  for (const auto& [kind, bits, type] : {std::tuple(kPcm, 8U, NumberType::u8),
                                         {kPcm, 16U, NumberType::i16},
                                         {kPcm, 24U, NumberType::i24},
                                         {kPcm, 32U, NumberType::i32},
                                         {kFloat, 32U, NumberType::f32},
                                         {kFloat, 64U, NumberType::f64}})
    if (header.kind == kind && header.bits == bits) return type;
  return std::nullopt;
}

std::unique_ptr<RowSource> open_wav(const std::string& path, const ReadOptions& options) {
  auto file = std::make_unique<BinaryFile>(path);
  const WavHeader header = read_header(*file);
  const auto type = number_of(header);
  if (!type)
    throw wav_refusal(*file, 12)
        .says("samples of {} bits in encoding {} are not read", header.bits, header.kind)
        .hint("PCM of 8, 16, 24 or 32 bits and floats are: ffmpeg -i FILE -c:a pcm_s24le log.wav");
  const std::uint64_t item = size_of(*type), row = item * header.channels;
  if (header.channels > kMaxColumns)
    throw wav_refusal(*file, 22).says("has {} channels, more than the limit of {}", header.channels, kMaxColumns);
  if (header.channels == 0 || header.rate_hz == 0 || header.row_bytes != row)
    throw wav_refusal(*file, 12).says("has a broken format: {} channels, {} Hz, {} bytes for each row", header.channels,
                                      header.rate_hz, header.row_bytes);
  BinaryLayout layout;
  const std::uint64_t present = file->size() - header.data_byte;
  layout.rows = std::min(header.data_bytes == 0 ? present : header.data_bytes, present) / row;
  if (layout.rows == 0) throw input_error("E0322", path).says("holds no samples");
  if (header.data_bytes > present && header.data_bytes < kUnknownSize)
    layout.warnings.add("cut_end", "the file ends inside of its samples: the whole rows up to there are read",
                        fmt::format("row {}", layout.rows));
  layout.data_byte = header.data_byte;
  layout.data_bytes = layout.rows * row;
  for (std::uint64_t c = 0; c < header.channels; ++c) {
    BinaryColumn column{fmt::format("c{}", c), "", {*type, false}, header.data_byte + c * item, row};
    if (!is_float(*type)) column.scale = std::ldexp(1.0, 1 - static_cast<int>(header.bits));
    if (*type == NumberType::u8) column.offset = -1;
    layout.columns.push_back(std::move(column));
  }
  LogInfo info;
  info.format = "wav";
  info.time.rate_hz = static_cast<double>(header.rate_hz);
  info.dialect = {fmt::format("{} of {} bits, full scale is ±1 (`channel_scale` says what that is)",
                              is_float(*type) ? "floats" : "PCM", header.bits)};
  return open_binary_rows(std::move(file), std::move(layout), std::move(info), options);
}

}  // namespace

Format wav_format() {
  Format row;
  row.about.name = "wav";
  row.about.title = "WAV";
  row.about.suffixes = {".wav"};
  row.about.names = row.about.units = row.about.start = "no";
  row.about.rate = "yes";
  row.about.rows_at_places = true;
  row.certain = [](std::string_view front) {
    return (front.starts_with("RIFF") || front.starts_with("RF64")) && front.substr(0, 12).ends_with("WAVE");
  };
  row.open = open_wav;
  return row;
}

}  // namespace libchar
