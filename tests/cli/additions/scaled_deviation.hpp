#pragma once
// The smallest Allan statistic, for the test that it costs a row: the overlapping Allan deviation times tau / sqrt(3).

#define LIBCHAR_MORE_DEVIATIONS \
  {static_cast<Type>(16), "scaled-oadev", "Scaled overlapping Allan deviation", 2, false, 2, true, true, false},
