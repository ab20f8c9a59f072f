# SPDX-License-Identifier: Apache-2.0
# Completion of tonewright for bash.

_tonewright() {
    local rest=${COMP_LINE:0:COMP_POINT} words=() word spaces line typed broken i
    # Bash splits words at `:` and `=`, too. A piece that no blank precedes belongs to the word before it.
    for ((i = 0; i <= COMP_CWORD; i++)); do
        spaces=${rest%%[![:space:]]*}
        rest=${rest#"$spaces"}
        word=${COMP_WORDS[i]}
        ((i < COMP_CWORD)) || word=$rest # only what stands before the cursor
        rest=${rest#"$word"}
        if ((i > 0)) && [ -z "$spaces" ]; then words[-1]+=$word; else words+=("$word"); fi
    done
    for i in "${!words[@]}"; do # without quotes
        word=${words[i]//\\/}
        words[i]=${word//[\"\']/}
    done
    typed=${words[-1]}
    # Readline replaces only what stands behind the last `:` or `=`.
    broken=${typed%"${typed##*[:=]}"}
    [[ $COMP_WORDBREAKS == *:* && $COMP_WORDBREAKS == *=* ]] || broken=
    COMPREPLY=()
    while IFS= read -r line; do
        case $line in
            :files | :folders)
                compopt -o filenames
                word=${typed##*=}
                [[ $typed == -*=* ]] || word=$typed
                i=-f
                [ "$line" = :files ] || i=-d
                while IFS= read -r word; do COMPREPLY+=("${word#"$broken"}"); done < <(compgen "$i" -- "$word")
                ;;
            *)
                word=${line%%$'\t'*}
                [[ $word != *[:=] ]] || compopt -o nospace
                printf -v word %q "${word#"$broken"}"
                COMPREPLY+=("$word")
                ;;
        esac
    done < <("${words[0]}" complete "${words[@]:1}" 2>/dev/null)
}
complete -F _tonewright tonewright
