// The smallest log format, for the test that one file and one line are all a format takes: each byte is a sample.

#include <fstream>
#include <iterator>

#include "libchar/log/detail/format.hpp"

namespace libchar {
namespace {

class ByteRows final : public RowSource {
 public:
  ByteRows(const std::string& path, const ReadOptions&) {
    std::ifstream file(path, std::ios::binary);
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
    info_.file = path;
    info_.format = "bytes";
    info_.bytes = bytes_.size();
    info_.channels.push_back({"c0", "", true});
  }
  const LogInfo& info() const override { return info_; }
  bool next(RowBlock& block, Warnings&) override {
    if (done_ || bytes_.empty()) return false;
    done_ = true;
    block.rows = bytes_.size();
    block.columns.assign(1, {bytes_.begin(), bytes_.end()});
    block.time_ns.clear();
    return true;
  }
  std::string place(const RowBlock&, std::size_t i, std::uint64_t before) const override {
    return "byte " + std::to_string(before + i);
  }
  std::uint64_t bytes_read() const override { return done_ ? bytes_.size() : 0; }
  std::uint64_t bytes_total() const override { return bytes_.size(); }
  std::string sha256() override { return ""; }

 private:
  std::vector<char> bytes_;
  LogInfo info_;
  bool done_ = false;
};

bool sniff_bytes(const std::string&, std::string_view) {
  return false;
}

std::unique_ptr<RowSource> open_bytes(const std::string& path, const ReadOptions& options) {
  return std::make_unique<ByteRows>(path, options);
}

}  // namespace

Format bytes_format() {
  Format row;
  row.about.name = "bytes";
  row.about.title = "bytes";
  row.about.brief = ".bytes";
  row.about.suffixes = {".bytes"};
  row.about.names = row.about.units = row.about.rate = row.about.start = "no";
  row.sniff = sniff_bytes;
  row.open = open_bytes;
  return row;
}

}  // namespace libchar
