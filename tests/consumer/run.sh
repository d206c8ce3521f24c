#!/usr/bin/env bash
# Installs the build in $1 into a temporary prefix; builds and runs against it a consumer of everything, and one of the curves
# alone that is not to find Ceres.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
cmake --install "$1" --prefix "$prefix/installed" >/dev/null

# consumer FOLDER EXPECTED OPTION…
consumer() {
  local build="$prefix/$(basename "$1")" expected=$2 result
  cmake -S "$1" -B "$build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix/installed" --log-level=WARNING --no-warn-unused-cli "${@:3}" >/dev/null
  cmake --build "$build" >"$build/log" || { cat "$build/log"; exit 1; }
  result=$("$build/consumer")
  [ "$result" = "$expected" ] || { echo "$1 printed $result, $expected was expected"; exit 1; }
}
consumer "$here" "0.707107 0.1"
consumer "$here/curves" 0.707107 -DCMAKE_DISABLE_FIND_PACKAGE_Ceres=ON
if grep -l Ceres "$prefix"/installed/lib*/cmake/libchar/libcharCurvesTargets*.cmake "$prefix"/installed/lib/*/cmake/libchar/libcharCurvesTargets*.cmake 2>/dev/null; then
  echo "libchar::curves links Ceres"
  exit 1
fi
