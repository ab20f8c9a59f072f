# SPDX-License-Identifier: Apache-2.0
"""Lines and branches of src/ that tests have run, by folder, as gcov counts them.

    cmake --preset coverage && cmake --build --preset coverage
    ctest --test-dir build/coverage -j 2 -E '^cli$|cli.kill|bench|install|farm'
    ctest --test-dir build/coverage -R '^cli$'
    python3 tests/coverage.py build/coverage [SOURCE_TREE]

Needs gcovr. Branches that only exceptions take are not counted. `cli` fills disks and stops programs, which damages counts:
it comes last, and then some of its checks fail. Threads lose counts, so the numbers say whether a line ran, not how often.
"""

import collections
import json
import subprocess
import sys
from pathlib import Path


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    build, source = Path(sys.argv[1]).resolve(), Path(*sys.argv[2:3] or ".").resolve()
    # gcov cannot merge a few templates of system headers; ours are whole.
    done = subprocess.run(["gcovr", "--root", source, "--filter", f"{source}/src/", "--object-directory", build,
                           "--exclude-throw-branches", "--exclude-unreachable-branches", "--gcov-ignore-parse-errors",
                           "--json-summary", "-", build], stdout=subprocess.PIPE, check=True)
    counts = collections.defaultdict(lambda: [0, 0, 0, 0])
    for file in json.loads(done.stdout)["files"]:
        folder = file["filename"].split("/")[1]
        for name in (folder, "all"):
            for i, key in enumerate(("line_covered", "line_total", "branch_covered", "branch_total")):
                counts[name][i] += file[key]
    print(f"{'folder':12} {'lines':>8} {'run':>7} {'branches':>9} {'taken':>7}")
    for folder, (lines, all_lines, branches, all_branches) in sorted(counts.items(), key=lambda item: (item[0] == "all", item[0])):
        print(f"{folder:12} {all_lines:8} {100 * lines / max(all_lines, 1):6.1f}% {all_branches:9} "
              f"{100 * branches / max(all_branches, 1):6.1f}%")


if __name__ == "__main__":
    main()
