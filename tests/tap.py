# SPDX-License-Identifier: BSD-3-Clause
"""Execution of test functions, with results in the form of TAP."""
import traceback


def run(tests, before=None):
    """Execute `tests`, pairs of a name and a function, and print each result. A function returns
    None, or the reason why the test is not possible (it is then skipped), and fails by an exception.
    `before`: function that is called before each test. Returns whether a test failed."""
    print("1..%d" % len(tests), flush=True)
    failed = False
    for number, (name, test) in enumerate(tests, 1):
        try:
            if before:
                before()
            reason = test()
            print("ok %d %s%s" % (number, name, " # SKIP " + reason if reason else ""), flush=True)
        except Exception:
            failed = True
            print("not ok %d %s" % (number, name))
            print("".join("# %s\n" % line for line in traceback.format_exc().split("\n")),
                  end="", flush=True)
    return failed
