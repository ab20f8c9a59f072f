#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `tonewright verify` of operators on displays, or of a config. `./run test --all` measures more samples, all operators,
# and more views with every instruction set.
#   verify.sh TONEWRIGHT [--half] [--best-target] ARGS...
# --half: every second operator, by the commit's hash or TONEWRIGHT_TEST_SHARE
command=$1
shift
operators=
if [ "$1" = --half ]; then
    shift
    operators=all
    if [ "$TONEWRIGHT_TEST_ALL" != 1 ]; then
        commit=$(git rev-parse HEAD 2>/dev/null | cut -c1-8)
        share=${TONEWRIGHT_TEST_SHARE:-0x${commit:-0}}
        operators=$("$command" list --views | cut -f1 | awk -v share=$((share % 2)) 'NR % 2 == share')
        echo "share $((share % 2)) of 2 (TONEWRIGHT_TEST_SHARE=$((share % 2)); \`./run test --all\` takes all)"
    fi
fi
if [ "$TONEWRIGHT_TEST_ALL" != 1 ]; then
    set -- --quick "$@"
elif [ "$1" = --best-target ]; then
    shift
fi
exec "$command" verify $operators "$@"
