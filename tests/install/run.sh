#!/bin/sh
# Installs a build into a folder of its own, then builds and runs the consumer project against it.
# Usage: run.sh BUILD_DIR WORK_DIR
set -eu
build=$1
work=$2
here=$(cd "$(dirname "$0")" && pwd)
rm -rf "$work"
cmake --install "$build" --prefix "$work/prefix" >/dev/null
cmake -S "$here" -B "$work/build" -DCMAKE_BUILD_TYPE=Release -DCMAKE_PREFIX_PATH="$work/prefix"
cmake --build "$work/build"
"$work/build/consumer"
# The command finds the module with its picture commands where it is installed.
"$work/prefix/bin/tonewright" chart -o "$work/chart.exr" --width 320 --height 180
"$work/prefix/bin/tonewright" apply "$work/chart.exr" "$work/chart.png" --operator hable
test -s "$work/chart.png"
