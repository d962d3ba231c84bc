#!/usr/bin/env bash
# Installs what the tests need, builds Release into build/test and runs every test. Arguments go to ctest.
set -euo pipefail
root=$(cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/test

"$root/tools/setup.sh" --test

mkdir -p "$build"
if ! { cmake -S "$root" -B "$build" -DCMAKE_BUILD_TYPE=Release -DRISORIUS_TESTS=ON &&
       cmake --build "$build" -j"$(nproc)"; } >"$build/build.log" 2>&1; then
  tail -n 60 "$build/build.log" >&2
  echo "test.sh: the build failed; the whole log is $build/build.log" >&2
  exit 1
fi

# a test that needs a device fails without one
RIS_REQUIRE_GPU=1 ctest --test-dir "$build" --output-on-failure -j"$(nproc)" "$@"
