#!/usr/bin/env bash
# The page's compiler takes every source, so that the page cannot rot unseen: unoptimised, with stand-ins for the libraries, nothing linked.
# usage: compiles.sh BUILD     what was compiled before is not compiled again; from nothing it takes 280 s of processor time
set -euo pipefail
cd "$(dirname "$0")/../.."
build=$(mkdir -p "$1" && realpath "$1")
tools/page/build/libraries "$build/stand-ins" --headers
cmake -S . -B "$build" -G Ninja --log-level=ERROR "-DCMAKE_TOOLCHAIN_FILE=$PWD/tools/page/build/toolchain.cmake" "-DPAGE_LIBRARIES=$build/stand-ins" \
  -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON -DLIBCHAR_TESTS=OFF -DLIBCHAR_BENCH=OFF -DCMAKE_CXX_FLAGS_RELEASE=-O0 -DLIBCHAR_COLD=-O0 >/dev/null
cmake --build "$build" --target libchar sensorchar_parts -- -k 0
