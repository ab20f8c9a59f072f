#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# npm packages at exact versions and all that they need, in a folder of their own; their install scripts do not run. For the
# other scripts here:
#   source lib/npm.bash FOLDER PACKAGE@VERSION...
# JavaScript files in FOLDER can then import them.
{ command -v node && command -v npm; } >/dev/null || { echo "node and npm are missing"; exit 2; }
echo '{"private": true}' >"$1/package.json"
npm install --prefix "$1" --ignore-scripts --no-audit --no-fund --save-exact "${@:2}" >"$1/npm.log" 2>&1 ||
    { echo "these versions are not in the configured npm registry:" "${@:2}"; head -2 "$1/npm.log"; exit 2; }
echo "node $(node --version); ${*:2}"
