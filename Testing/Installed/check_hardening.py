# SPDX-License-Identifier: BSD-3-Clause
"""check_hardening.py FILE...: fails unless every program and library is built with the hardening flags of Debian."""
import platform
import re
import subprocess
import sys


def readelf(option, path):
    run = subprocess.run(["readelf", "-W", option, path], capture_output=True, text=True, check=True)
    return run.stdout


def flaws(path):
    header, segments, dynamic = (readelf(option, path) for option in ("-h", "-l", "-d"))
    symbols = readelf("--dyn-syms", path)
    stack = [line for line in segments.splitlines() if "GNU_STACK" in line]
    checks = {
        "loads at any address": "DYN (" in header,
        "tables are read-only once linked": "GNU_RELRO" in segments,
        "all symbols are bound at the start": bool(re.search(r"\b(BIND_)?NOW\b", dynamic)),
        "the stack cannot be executed": len(stack) == 1 and "RWE" not in stack[0],
        "the stack is guarded": "__stack_chk_fail" in symbols,
    }
    if platform.machine() == "x86_64":
        # The note that says so of the whole file also needs a C library built that way.
        code = subprocess.run(["objdump", "-d", path], capture_output=True, text=True, check=True).stdout
        checks["targets of jumps are marked"] = "endbr64" in code
    return [words for words, good in checks.items() if not good]


bad = 0
for path in sys.argv[1:]:
    missing = flaws(path)
    print(path.rsplit("/", 1)[-1] + ":", "; ".join("not so: " + words for words in missing) or "hardened")
    bad += bool(missing)
if not any("_chk@" in readelf("--dyn-syms", path).replace("__stack_chk", "") for path in sys.argv[1:]):
    print("not so: copies and formats are checked (_FORTIFY_SOURCE)")
    bad += 1
sys.exit(bad != 0)
