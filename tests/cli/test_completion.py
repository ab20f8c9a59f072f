# SPDX-License-Identifier: Apache-2.0
"""Completion in bash, fish and zsh: each script completes lines, as the shell calls it."""

import os
import re
import shlex
import subprocess

import pytest
from pictures import PROJECT, need_program

SCRIPTS = PROJECT / "src" / "cli" / "completions"
# Line -> a word that completes its last one, as users know it from the documents.
LINES = {
    "tonewright ba": "bake",
    "tonewright bake agx_sob": "agx_sobotka",
    "tonewright bake reinhard:lu": "reinhard:luminance",
    "tonewright bake agx_blender --look pun": "punchy",
    "tonewright bake hable --display rec2100_p": "rec2100_pq",
    "tonewright bake hable --for res": "resolve",
    "tonewright bake hable --for=res": "--for=resolve",
    "tonewright shader hable --language wg": "wgsl",
    "tonewright compare --spl": "--split",
    "tonewright import READ": "README.md",
}


def bash(line):
    words = re.findall(r"[:=]|[^\s:=]+", line)  # as Readline splits them
    script = f"""source {SCRIPTS}/tonewright.bash; compopt() {{ :; }}
        COMP_LINE={shlex.quote(line)}; COMP_POINT=${{#COMP_LINE}}
        COMP_WORDS=({shlex.join(words)}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))
        _tonewright; printf '%s\\n' "${{COMPREPLY[@]}}\""""
    return ["bash", "--norc", "-c", script]


def fish(line):
    return ["fish", "--no-config", "-c", f"source {SCRIPTS}/tonewright.fish; complete -C {shlex.quote(line)}"]


# On Tab, zsh writes all words that complete the line into it.
ZSHRC = f"""
    fpath=({SCRIPTS} $fpath); autoload -Uz compinit; compinit -u -D
    insert_all() {{ _main_complete; compstate[insert]=all }}
    zle -C insert_all complete-word insert_all; bindkey '^I' insert_all
    show() {{ print -r -- "<<$BUFFER>>" }}
    zle -N show; bindkey '^X' show; PS1=READY
"""


def zsh(line):
    script = f"""zmodload zsh/zpty; zpty shell zsh -d -i; zpty -r shell out '*READY*'
        zpty -w -n shell {shlex.quote(line)}$'\\t\\x18'; zpty -r shell out '*>>*'
        print -rl -- ${{=${{${{out##*<<}}%%>>*}}}}"""
    return ["zsh", "-f", "-c", script]


@pytest.mark.parametrize("shell", [bash, fish, zsh])
def test_shell(report, command, scratch, shell):
    need_program(shell.__name__, shell.__name__)
    (scratch / ".zshrc").write_text(ZSHRC)
    environment = {**os.environ, "PATH": f"{command.parent}:{os.environ['PATH']}", "ZDOTDIR": str(scratch), "TERM": "dumb"}
    for line, wanted in LINES.items():
        # Bash replaces the text after the last `:` or `=`.
        word = re.split("[:=]", wanted)[-1] if shell is bash else wanted
        done = subprocess.run(shell(line), cwd=PROJECT, env=environment, capture_output=True, text=True, check=False, timeout=60)
        words = [offered.split("\t")[0] for offered in done.stdout.splitlines()]
        report.check(f"{shell.__name__}: {line} -> {wanted}", word in words, (words, done.stderr))
