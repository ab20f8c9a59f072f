# SPDX-License-Identifier: Apache-2.0
# Completion of tonewright for fish.

function __tonewright_complete
    set -l words (commandline -opc)
    set -l typed (commandline -ct)
    for line in ($words[1] complete $words[2..-1] "$typed" 2>/dev/null)
        switch $line
            case :files
                __fish_complete_path (string replace -r -- '^--[^=]*=' '' "$typed")
            case :folders
                __fish_complete_directories (string replace -r -- '^--[^=]*=' '' "$typed")
            case '*'
                printf '%s\n' $line
        end
    end
end

complete -c tonewright -f -a '(__tonewright_complete)'
