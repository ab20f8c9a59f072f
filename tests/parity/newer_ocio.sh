#!/bin/sh
# Runs tests under pytest with another OpenColorIO than the installed one: `$TONEWRIGHT_NEWER_OCIO python3 -m pytest ARGS...`,
# where TONEWRIGHT_NEWER_OCIO is a program that runs what follows it with that OpenColorIO's Python, which has NumPy and pytest.
#   newer_ocio.sh ARGS...
[ -n "$TONEWRIGHT_NEWER_OCIO" ] || { echo "skipped: TONEWRIGHT_NEWER_OCIO is not set"; exit 77; }
export PYTHONDONTWRITEBYTECODE=1 PYTEST_DISABLE_PLUGIN_AUTOLOAD=1
exec "$TONEWRIGHT_NEWER_OCIO" python3 -m pytest -c tests/pytest.ini -v "$@"
