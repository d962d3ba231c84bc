#!/usr/bin/env bash
# Installs the build into a fresh prefix, builds consumer.c against it with pkg-config alone and runs it.
# usage: run.sh BUILD_DIR SOURCE_DIR C_COMPILER
set -euo pipefail
build=$1 source=$2 cc=$3
here=$source/tests/consumer
prefix=$build/consumer/prefix
rm -rf -- "$build/consumer"
mkdir -p "$build/consumer"
cmake --install "$build" --prefix "$prefix" >"$build/consumer/install.log"

pc=$(find "$prefix" -name risorius.pc)
export PKG_CONFIG_PATH=${pc%/*}
# pkg-config joins flags by blanks and escapes them: let the shell take them apart
eval "flags=($(pkg-config --cflags --libs risorius))"
"$cc" -std=c11 -Wall -Wextra -Werror "$here/consumer.c" "${flags[@]}" -lm -o "$build/consumer/consumer"

# every installed header compiles alone
eval "flags=($(pkg-config --cflags risorius))"
for header in "$prefix"/include/risorius/*.h; do
  echo "#include <risorius/${header##*/}>" | "$cc" -std=c11 -Wall -Wextra -Werror "${flags[@]}" -fsyntax-only -x c -
done

"$build/consumer/consumer" "$source/assets/human"
"$prefix/bin/risorius" --version
# the negative control: a head that is not there must give the data exit code
if "$build/consumer/consumer" "$build/no-such-head" 2>/dev/null; then exit 1; else [[ $? == 3 ]]; fi
