#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `tonewright verify` of operators on displays, or of a config. `./run test --all` measures more samples, all operators,
# and more views with every instruction set.
#   verify.sh TONEWRIGHT [--best-target] ARGS...
command=$1
shift
if [ "$TONEWRIGHT_TEST_ALL" != 1 ]; then
    set -- --quick "$@"
elif [ "$1" = --best-target ]; then
    shift
fi
# shader.verify runs the other languages.
exec "$command" verify --shaders glsl "$@"
