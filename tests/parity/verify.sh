#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# `tonewright verify`, with smaller sample sets unless `./run test --all` runs it.
#   verify.sh TONEWRIGHT ARGS...
command=$1
shift
[ "$TONEWRIGHT_TEST_ALL" = 1 ] || set -- --quick "$@"
exec "$command" verify "$@"
