#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `tonewright verify` of operators on displays, or of a config. `./run test --all` measures more samples, all operators,
# and more views with every instruction set.
#   verify.sh TONEWRIGHT [--half|--half-displays] [--best-target] ARGS...
# --half, --half-displays: every second operator or display, by the commit's hash or TONEWRIGHT_TEST_SHARE
command=$1
shift
commit=$(git rev-parse HEAD 2>/dev/null | cut -c1-8)
share=$((${TONEWRIGHT_TEST_SHARE:-0x${commit:-0}} % 2))
half() {
    echo "share $share of 2 (TONEWRIGHT_TEST_SHARE=$share; \`./run test --all\` takes all)" >&2
    awk -v share=$share 'NR % 2 == share'
}
operators=
case $1 in
--half)
    shift
    operators=all
    [ "$TONEWRIGHT_TEST_ALL" = 1 ] || operators=$("$command" list --views | cut -f1 | half)
    ;;
--half-displays)
    shift
    [ "$TONEWRIGHT_TEST_ALL" = 1 ] || set -- "$@" $("$command" list --json |
        python3 -c 'import json, sys; print(*(d["id"] for d in json.load(sys.stdin)["displays"]), sep="\n")' |
        half | sed 's/^/--display /')
    ;;
esac
if [ "$TONEWRIGHT_TEST_ALL" != 1 ]; then
    set -- --quick "$@"
elif [ "$1" = --best-target ]; then
    shift
fi
# shader.verify runs the other languages.
exec "$command" verify $operators --shaders glsl "$@"
