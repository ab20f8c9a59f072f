# SPDX-License-Identifier: Apache-2.0
"""Completion in bash, fish and zsh: each script completes lines, as the shell calls it.

    python3 tests/cli/test_completion.py build/release/bin/tonewright

The last line is `N passed, M failed`.
"""

import argparse
import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "parity" / "clients"))
from pictures import SKIPPED, Report  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
SCRIPTS = ROOT / "src" / "cli" / "completions"
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


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("command", type=Path)
    folder = parser.parse_args().command.resolve().parent
    shells = [shell for shell in (bash, fish, zsh) if shutil.which(shell.__name__)]
    if len(shells) < 3:
        print("bash, fish or zsh is not installed")
        return SKIPPED
    report = Report()
    with tempfile.TemporaryDirectory() as home:
        (Path(home) / ".zshrc").write_text(ZSHRC)
        environment = {**os.environ, "PATH": f"{folder}:{os.environ['PATH']}", "ZDOTDIR": home, "TERM": "dumb"}
        for shell in shells:
            for line, wanted in LINES.items():
                # Bash replaces the text after the last `:` or `=`.
                word = re.split("[:=]", wanted)[-1] if shell is bash else wanted
                done = subprocess.run(shell(line), cwd=ROOT, env=environment, capture_output=True, text=True, check=False,
                                      timeout=60)
                words = [offered.split("\t")[0] for offered in done.stdout.splitlines()]
                report.check(f"{shell.__name__}: {line} -> {wanted}", word in words, (words, done.stderr))
    return report.finish()


if __name__ == "__main__":
    sys.exit(main())
