#!/usr/bin/env bash
# Installs the build in $1 into a temporary prefix and builds and runs the consumer against it.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
prefix=$(mktemp -d)
trap 'rm -rf "$prefix"' EXIT
cmake --install "$1" --prefix "$prefix/installed" >/dev/null
cmake -S "$here" -B "$prefix/build" -G Ninja -DCMAKE_PREFIX_PATH="$prefix/installed" --log-level=WARNING
cmake --build "$prefix/build" >/dev/null
result=$("$prefix/build/consumer")
[ "$result" = 0.707107 ] || { echo "consumer printed $result, 0.707107 was expected"; exit 1; }
