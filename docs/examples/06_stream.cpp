// A log of any length, block by block in constant memory: an Allan curve of one channel.
#include <cstdio>

#include "libchar/libchar.hpp"

struct Curve : libchar::BlockSink {
  libchar::AllanPyramid pyramid;
  void begin(const libchar::LogInfo&) override {}
  void block(const libchar::SampleBlock& samples) override { pyramid.push({samples.channels[0], samples.rows}); }
};

int main() {
  libchar::ReadOptions options;
  options.channels = {"gyro_z"};
  Curve curve;
  const libchar::LogInfo log = libchar::read_log("fixtures/imu_at_rest.csv", options, curve);
  for (const libchar::AllanPoint& p : curve.pyramid.finish(1 / log.time.rate_hz).points)
    if (p.tau_s >= 0.5 && p.tau_s < 5) std::printf("%5.2f s  %.2e\n", p.tau_s, p.deviation);
}
