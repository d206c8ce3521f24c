#include "libchar/log/write/value_writer.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "libchar/core/file/unfinished_files.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"

namespace libchar {
namespace {

constexpr std::size_t kStretch = std::size_t{1}
                                 << 19U;  // bytes of one column that are kept before they go to the spool

}  // namespace

ValueWriter::ValueWriter(WholeFile& file, std::size_t channels, NumberFormat number, bool column_major)
    : file_(file), number_(number), column_major_(column_major && channels > 1) {
  if (!column_major_) return;
  pending_.resize(channels);
  spool_ = open_nameless(std::filesystem::path(file.path()).parent_path());
  if (spool_ < 0) fail("create a temporary file next to it");
}

ValueWriter::~ValueWriter() {
  if (spool_ >= 0) ::close(spool_);
}

void ValueWriter::fail(const char* doing) const {
  throw output_error("E0501", file_.path()).says("cannot {}: {}", doing, std::strerror(errno));
}

void ValueWriter::encode(double value, std::byte* to) {
  if (number_.type == NumberType::f32 && std::isfinite(value)) {
    if (std::abs(value) > static_cast<double>(std::numeric_limits<float>::max()))
      throw output_error("E0511", file_.path())
          .says("a value does not fit 32 bits")
          .got(shortest(value))
          .hint("write f64");
    rounded_ += static_cast<double>(static_cast<float>(value)) != value;
  }
  write_number(value, number_, to);
}

void ValueWriter::write(std::span<const std::span<const double>> columns) {
  const std::size_t rows = columns.empty() ? 0 : columns[0].size();
  const std::size_t item = size_of(number_.type);
  rows_ += rows;
  if (!column_major_) {
    bytes_.resize(rows * columns.size() * item);
    for (std::size_t c = 0; c < columns.size(); ++c) {
      assert(columns[c].size() == rows);
      for (std::size_t i = 0; i < rows; ++i) encode(columns[c][i], bytes_.data() + (i * columns.size() + c) * item);
    }
    file_.write(bytes_.data(), bytes_.size());
    return;
  }
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t before = pending_[c].size();
    pending_[c].resize(before + rows * item);
    for (std::size_t i = 0; i < rows; ++i) encode(columns[c][i], pending_[c].data() + before + i * item);
  }
  if (pending_[0].size() >= kStretch) spill();
}

void ValueWriter::spill() {
  if (pending_[0].empty()) return;
  stretch_bytes_.push_back(pending_[0].size());
  for (std::vector<std::byte>& column : pending_) {
    for (std::size_t done = 0; done < column.size();) {
      const ssize_t n = ::write(spool_, column.data() + done, column.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail("write a temporary file next to it");
      done += static_cast<std::size_t>(n);
    }
    column.clear();
  }
}

void ValueWriter::finish() {
  if (!column_major_) return;
  spill();
  for (std::size_t c = 0; c < pending_.size(); ++c) {
    std::uint64_t spill_begin = 0;  // a spill holds one stretch of every column
    for (const std::uint64_t stretch : stretch_bytes_) {
      bytes_.resize(static_cast<std::size_t>(stretch));
      for (std::size_t done = 0; done < bytes_.size();) {
        const ssize_t n = ::pread(spool_, bytes_.data() + done, bytes_.size() - done,
                                  static_cast<off_t>(spill_begin + c * stretch + done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) fail("read its temporary file back");
        done += static_cast<std::size_t>(n);
      }
      file_.write(bytes_.data(), bytes_.size());
      spill_begin += stretch * pending_.size();
    }
  }
}

}  // namespace libchar
