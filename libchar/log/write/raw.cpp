// Raw binary with a JSON sidecar: the format that keeps everything (names, units, rate, start).

#include <fmt/format.h>
#include <sys/stat.h>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/binary/sidecar.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/write/value_writer.hpp"
#include "libchar/log/write/writers.hpp"

namespace libchar {
namespace {

// Beside /dev/stdout there is /dev.
const std::string& with_place_beside(const std::string& path) {
  if (writes_through(path))
    throw output_error("E0518", path)
        .says("raw data need a sidecar file, which a pipe or device cannot have")
        .hint("write to a file, or another format");
  return path;
}

// Another sidecar beside the log would contradict ours.
void refuse_other_sidecar(const std::string& path) {
  for (const char* suffix : {".yaml", ".yml"}) {
    struct stat status {};
    if (::stat((path + suffix).c_str(), &status) == 0)
      throw output_error("E0509", path + suffix)
          .says("is a sidecar of this name already")
          .hint("remove it or choose another name");
  }
}

class RawWriter final : public LogWriter {
 public:
  RawWriter(const std::string& path, const LogInfo& info, const WriteOptions& options)
      : file_(with_place_beside(path), options.overwrite), beside_(path + ".json", options.overwrite) {
    refuse_other_sidecar(path);
    sidecar_.number = {options.dtype == "f32" ? NumberType::f32 : NumberType::f64, options.big_endian};
    sidecar_.planar = options.order == "planar";
    sidecar_.named = !unnamed(info.channels);
    for (const Channel& channel : info.channels) {
      sidecar_.named = sidecar_.named || !channel.unit.empty();
      sidecar_.channels.push_back({printable(channel.name), printable(channel.unit), 1, 0});
    }
    refine(info);
    values_.emplace(file_, sidecar_.channels.size(), sidecar_.number, sidecar_.planar);
  }

  void write(std::span<const std::span<const double>> columns) override { values_->write(columns); }

  void refine(const LogInfo& info) override {
    sidecar_.rate_hz = info.time.rate_hz;
    sidecar_.t0_ns = info.time.start_ns;
  }

  std::vector<WholeFile*> complete() override {
    values_->finish();
    sidecar_.rows = values_->rows();
    beside_.write(sidecar_json(sidecar_));
    return {&file_, &beside_};
  }
  std::vector<std::string> files() const override { return {file_.path(), beside_.path()}; }

  std::vector<std::string> losses() const override {
    if (values_->rounded() == 0) return {};
    return {fmt::format("{} values were rounded to 32 bits", values_->rounded())};
  }

 private:
  WholeFile file_, beside_;
  Sidecar sidecar_;
  std::optional<ValueWriter> values_;
};

}  // namespace

std::unique_ptr<LogWriter> write_raw(const std::string& path, const LogInfo& info, const WriteOptions& options) {
  return std::make_unique<RawWriter>(path, info, options);
}

}  // namespace libchar
