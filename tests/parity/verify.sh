#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `tonewright verify` of operators on displays, or of a config. `./run test` measures fewer samples, and with --half every
# second operator, by the commit's hash or TONEWRIGHT_TEST_SHARE, with the machine's best instruction set alone.
#   verify.sh TONEWRIGHT [--half] ARGS...
command=$1
shift
operators=
if [ "$1" = --half ]; then
    shift
    operators=all
    if [ "$TONEWRIGHT_TEST_ALL" != 1 ]; then
        commit=$(git rev-parse HEAD 2>/dev/null | cut -c1-8)
        share=$((${TONEWRIGHT_TEST_SHARE:-0x${commit:-0}} % 2))
        echo "share $share of 2 (TONEWRIGHT_TEST_SHARE=$share; \`./run test --all\` takes all)" >&2
        operators=$("$command" list --views | cut -f1 | awk -v share=$share 'NR % 2 == share')
        set -- --best-target "$@"
    fi
fi
[ "$TONEWRIGHT_TEST_ALL" = 1 ] || set -- --quick "$@"
# shader.verify runs the other languages.
exec "$command" verify $operators --shaders glsl "$@"
