// CSV as this project writes it: comma, point, one header line NAME[UNIT], shortest numbers that
// read back to the same bits.

#include <charconv>
#include <cmath>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/double_text.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/log/write/writers.hpp"

namespace libchar {
namespace {

std::string header_cell(const Channel& channel) {
  std::string text = begins_like_a_formula(channel.name) ? "'" + channel.name : channel.name;
  // A ratio has no unit to print: [1] would read as an index.
  if (!channel.unit.empty() && channel.unit != "1") text += "[" + channel.unit + "]";
  const bool blank_at_an_end = text.front() == ' ' || text.back() == ' ';
  if (!blank_at_an_end && text.find_first_of(",;\t\"\r\n#'") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

class CsvWriter final : public LogWriter {
 public:
  CsvWriter(const std::string& path, const LogInfo& info, const WriteOptions& options)
      : file_(path, options.overwrite),
        rate_(info.time.rate_hz),
        start_ns_(info.time.start_ns),
        stamped_(options.time_column && info.time.rate_hz > 0) {
    if (!stamped_) lost_.push_back(rate_ > 0 ? "the rate: no time column was wanted" : "");
    absolute_ = start_ns_ && std::abs(static_cast<double>(*start_ns_)) > kRelative;
    if (stamped_) text_ = absolute_ ? "t[ns]" : "t[s]";
    for (const Channel& channel : info.channels) text_ += (text_.empty() ? "" : ",") + header_cell(channel);
    text_ += '\n';
    // A row of nothing is no row for most readers.
    lone_ = !stamped_ && info.channels.size() == 1;
  }

  void write(std::span<const std::span<const double>> columns) override {
    const std::size_t rows = columns.empty() ? 0 : columns[0].size();
    for (std::size_t i = 0; i < rows; ++i, ++row_) {
      if (stamped_) put_stamp();
      for (std::size_t c = 0; c < columns.size(); ++c) {
        if (c > 0 || stamped_) text_ += ',';
        if (!std::isnan(columns[c][i]))
          put(columns[c][i]);
        else if (lone_)
          text_ += "nan";
      }
      text_ += '\n';
      if (text_.size() >= kPiece) flush();
    }
  }

  std::vector<WholeFile*> complete() override {
    flush();
    return {&file_};
  }
  std::vector<std::string> files() const override { return {file_.path()}; }
  std::vector<std::string> losses() const override {
    return !lost_.empty() && !lost_[0].empty() ? lost_ : std::vector<std::string>{};
  }

 private:
  // Stamps below ten days are seconds since some start, and a double holds them to 0.1 ns; above,
  // they are a calendar's.
  static constexpr double kRelative = 8.64e14;
  static constexpr std::size_t kPiece = std::size_t{1} << 16U;

  void put(double value) {
    char digits[40];
    text_.append(digits, detail::write_double(digits, digits + sizeof digits, value).ptr);
  }
  void put(long long value) {
    char digits[40];
    text_.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }

  // Row k stands at k / rate: computed, not summed, so that no error grows.
  void put_stamp() {
    const long double after = static_cast<long double>(row_) / static_cast<long double>(rate_);
    const long double ns = static_cast<long double>(start_ns_.value_or(0)) + after * 1e9L;
    if (!absolute_)
      put(static_cast<double>(static_cast<long double>(start_ns_.value_or(0)) / 1e9L + after));
    else if (after * 1e9L < 0x1p63L && std::abs(ns) < 0x1p63L)
      put(*start_ns_ + std::llroundl(after * 1e9L));
    else
      throw output_error("E0519", file_.path())
          .says("the stamps of this log leave 64-bit nanoseconds")
          .hint("write it as raw, or without the column of time");
  }

  void flush() {
    file_.write(text_);
    text_.clear();
  }

  WholeFile file_;
  double rate_;
  std::optional<std::int64_t> start_ns_;
  bool stamped_, absolute_ = false, lone_ = false;
  std::uint64_t row_ = 0;
  std::string text_;
  std::vector<std::string> lost_;
};

}  // namespace

std::unique_ptr<LogWriter> write_csv(const std::string& path, const LogInfo& info, const WriteOptions& options) {
  return std::make_unique<CsvWriter>(path, info, options);
}

}  // namespace libchar
