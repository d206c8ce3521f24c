// .npy: a structured array with one field a channel when the channels have names of their own, else a plain 2-D array.

#include <fmt/format.h>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/npy_header.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/write/value_writer.hpp"
#include "libchar/log/write/writers.hpp"

namespace libchar {
namespace {

// A name as a Python literal.
std::string python_string(const std::string& name) {
  std::string quoted = "'";
  for (const char c : printable(name)) quoted += c == '\'' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
  return quoted + "'";
}

class NpyWriter final : public LogWriter {
 public:
  NpyWriter(const std::string& path, const LogInfo& info, const WriteOptions& options)
      : file_(path, options.overwrite),
        channels_(info.channels.size()),
        rate_(info.time.rate_hz),
        fortran_(options.order == "planar" && channels_ > 1) {
    const NumberFormat number{options.dtype == "f32" ? NumberType::f32 : NumberType::f64, options.big_endian};
    const std::string type = fmt::format("'{}f{}'", options.big_endian ? '>' : '<', size_of(number.type));
    descr_ = unnamed(info.channels) ? type : fields(info.channels, type);
    if (descr_ != type && (fortran_ || header(UINT64_MAX).size() > kMaxNpyHeader)) {
      losses_.push_back(fortran_ ? "channel names: a .npy file has them only row by row (interleaved)"
                                 : "channel names: there are too many for a .npy header");
      descr_ = type;
    }
    structured_ = descr_ != type;
    for (const Channel& channel : info.channels) {
      if (channel.unit.empty()) continue;
      losses_.emplace_back("units: a .npy file has no place for them");
      break;
    }
    file_.write(header(0));
    values_.emplace(file_, channels_, number, fortran_);
  }

  void write(std::span<const std::span<const double>> columns) override { values_->write(columns); }
  void refine(const LogInfo& info) override { rate_ = info.time.rate_hz; }

  std::vector<WholeFile*> complete() override {
    values_->finish();
    file_.rewrite(0, header(values_->rows()));
    return {&file_};
  }
  std::vector<std::string> files() const override { return {file_.path()}; }

  std::vector<std::string> losses() const override {
    std::vector<std::string> all = losses_;
    if (rate_ > 0) all.push_back(fmt::format("the sampling rate: read it back with `rate_hz` {}", shortest(rate_)));
    if (values_->rounded() > 0) all.push_back(fmt::format("{} values were rounded to 32 bits", values_->rounded()));
    return all;
  }

 private:
  static std::string fields(const std::vector<Channel>& channels, const std::string& type) {
    std::string list;
    for (const Channel& channel : channels) list += fmt::format("({}, {}), ", python_string(channel.name), type);
    return "[" + list + "]";
  }

  // Version 1.0 for ASCII names, 3.0 (UTF-8) for others; blanks make room for the largest count and
  // end on a multiple of 64.
  std::string header(std::uint64_t rows) const {
    bool ascii = true;
    for (const char c : descr_) ascii = ascii && static_cast<unsigned char>(c) < 0x80;
    const std::string shape = structured_ || descr_.front() == '[' || channels_ == 1
                                  ? fmt::format("({},)", rows)
                                  : fmt::format("({}, {})", rows, channels_);
    std::string text =
        fmt::format("{{'descr': {}, 'fortran_order': {}, 'shape': {}, }}", descr_, fortran_ ? "True" : "False", shape);
    const std::size_t begin = ascii ? 10 : 12;
    const std::size_t room = text.size() + (20 - fmt::formatted_size("{}", rows)) + 1;
    const std::size_t total = (begin + room + 63) / 64 * 64;
    text.resize(total - begin - 1, ' ');
    text += '\n';
    const std::size_t length = text.size();
    std::string magic = ascii ? std::string("\x93NUMPY\x01\x00", 8) : std::string("\x93NUMPY\x03\x00", 8);
    for (std::size_t i = 0; i < begin - 8; ++i) magic += static_cast<char>((length >> (8 * i)) & 0xFFU);
    return magic + text;
  }

  WholeFile file_;
  std::size_t channels_;
  double rate_;
  bool fortran_, structured_ = false;
  std::string descr_;
  std::vector<std::string> losses_;
  std::optional<ValueWriter> values_;
};

}  // namespace

std::unique_ptr<LogWriter> write_npy(const std::string& path, const LogInfo& info, const WriteOptions& options) {
  return std::make_unique<NpyWriter>(path, info, options);
}

}  // namespace libchar
