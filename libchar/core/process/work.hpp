#pragma once
// How much was done, in counts that are the same on every machine and for any number of threads: what shows that
// nothing is computed that nobody reads.

#include <array>
#include <cstddef>
#include <cstdint>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/document/json.hpp"

namespace libchar {

enum class WorkKind : std::size_t {
  passes,             ///< over a log or a simulation
  rows,               ///< of logs, in all passes
  segments,           ///< transformed for spectra
  cosine_transforms,  ///< of records and blocks, for fits
  floor_medians,      ///< of stretches of a spectrum that may hold a line
  allan_terms,        ///< differences that were averaged
  descents,           ///< of a likelihood or a sum of squares to its least
  simulated_samples,  ///< of sensors
  learnt_instants,    ///< given to fusion algorithms to learn from
  training_steps,     ///< of perceptrons
  fused_instants,     ///< estimates of fusion algorithms that are shown
  blind_instants      ///< the same for what is shown where there is no reference
};
template <>
inline constexpr auto enum_table<WorkKind> =
    enum_words<WorkKind,
               "passes rows segments cosine_transforms floor_medians allan_terms descents simulated_samples "
               "learnt_instants training_steps fused_instants blind_instants">;

using WorkDone = std::array<std::uint64_t, enum_table<WorkKind>.size()>;

/// {"passes": 1, …}: the kinds that were done at all.
Json work_json(const WorkDone& work);

/// Adds to the counts of the process, from any thread.
void count_work(WorkKind kind, std::uint64_t more);

/// The work of the process since its construction; parallel jobs count too.
class WorkMeter {
 public:
  WorkMeter();
  WorkDone done() const;

 private:
  WorkDone before_;
};

// How much heap a piece of work holds. The library cannot know; a program that counts (tools/heap_meter.cpp) can say.

struct HeapUse {
  std::int64_t held = 0;  ///< bytes allocated minus bytes freed since `begin`, on this thread
  std::int64_t peak = 0;  ///< largest value of `held` on the way
};

struct HeapMeter {
  virtual ~HeapMeter() = default;
  virtual void begin() = 0;
  virtual HeapUse end() = 0;
};

}  // namespace libchar
