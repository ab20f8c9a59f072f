# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash

# compare_core_files NATIVE COMMAND...: both write LUTs, shaders and numbers. All but those of the SIMD engine, which rounds by
# its instructions, have the same bytes.
compare_core_files() {
    local native=$1 folder differ file engines=0
    shift
    folder=$(mktemp -d)
    mkdir "$folder/native" "$folder/other"
    "$native" "$folder/native" >/dev/null
    echo "$* has the engines $("$@" "$folder/other")"
    differ=$(diff -rq "$folder/native" "$folder/other" | grep -v '\.simd\.txt ' || true)
    echo "$(find "$folder/native" -type f ! -name '*.simd.txt' | wc -l) files, $(grep -c . <<<"$differ" || true) of them differ"
    [ -z "$differ" ] || sed 's/^/  /' <<<"$differ"
    # Each engine is within 1e-6 (kSimdError) of the reference, absolutely up to 1 and relatively above.
    for file in "$folder"/native/*.simd.txt; do
        paste "$file" "$folder/other/${file##*/}" | awk -v name="${file##*/}" '
            { size = $1 < 0 ? -$1 : $1; d = $1 - $2; if (d < 0) d = -d; if (size > 1) d /= size; if (d > most) most = d }
            END { printf "  %s: at most %.2g apart\n", name, most; exit !(NR > 0 && most <= 2e-6) }' || engines=1
    done
    rm -rf "$folder"
    [ -z "$differ" ] && [ $engines -eq 0 ]
}
