#!/bin/sh
# Runs a test script with another OpenColorIO than the installed one: `$TONEWRIGHT_NEWER_OCIO python3 SCRIPT ARGS...`,
# where TONEWRIGHT_NEWER_OCIO is a program that runs what follows it with that OpenColorIO's Python.
#   newer_ocio.sh SCRIPT ARGS...
[ -n "$TONEWRIGHT_NEWER_OCIO" ] || { echo "skipped: TONEWRIGHT_NEWER_OCIO is not set"; exit 77; }
exec "$TONEWRIGHT_NEWER_OCIO" python3 "$@"
