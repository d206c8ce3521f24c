#pragma once
// One algorithm as C99 without the heap: its state, its start, its step. The numbers that it learnt are in the text.

#include <string>
#include <string_view>
#include <vector>

#include "libchar/fusion/array.hpp"
#include "libchar/fusion/learnt.hpp"
#include "libchar/fusion/options.hpp"

namespace libchar::fusion {

/// Operations of one step with all samples there; of the worst step where steps differ.
struct CCost {
  double sums = 0;  ///< additions and multiplications
  double divisions = 0, roots = 0, tanhs = 0, arctangents = 0;
};

/// Code uses the type `fusion_real`, the macros R() around a constant, TANH, ATAN2, RINT, FABS and LARGEST; channels N.
struct CForm {
  std::string state;  ///< members of `fusion_state`; largest types first
  std::string start;  ///< statements of `fusion_init` behind setting all to zero
  /// Functions, the last one static int estimate(fusion_state *s, const fusion_real *y, fusion_real *x,
  /// fusion_real *variance): 1 where there is an estimate; *variance below zero: not known.
  std::string functions;
  std::size_t reals = 0, words = 0, bytes = 0;  ///< of the state
  CCost cost;
  std::vector<std::string> notes;  ///< how it differs from the library's form
};

struct CChoice {
  std::string_view algorithm;
  const Array* array = nullptr;
  const Settings* settings = nullptr;
  const Learnt* learnt = nullptr;
  bool single = false;  ///< float
};

/// Throws Error(usage): no such form of it, or not for this array or these options.
CForm c_form(const CChoice& choice);

/// A number as a constant of C.
std::string c_number(double value, bool single);

}  // namespace libchar::fusion
