#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Unit test of tools/prose: samples with known faults at known lines."""
import importlib.machinery
import importlib.util
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
TOOL = os.path.join(ROOT, "tools", "prose")
loader = importlib.machinery.SourceFileLoader("prose", TOOL)
prose = importlib.util.module_from_spec(importlib.util.spec_from_loader("prose", loader))
sys.dont_write_bytecode = True
loader.exec_module(prose)

LONG = " ".join(["word"] * 31)
FULL = " ".join(["word"] * 30)
# name, name of the file, its content, expected (line, beginning of the fault)
CASES = [
    ("a clean header comment", "a.h",
     "/* Return the area in nm^2. The caller frees the result with eda_free. */\nint a;\n", []),
    ("an opening with What", "a.c", "int a;\n/* What was mended is found. */\n",
     [(2, "'mended'"), (2, "sentence begins with 'What'")]),
    ("each forbidden opening", "a.c",
     "/* One that has it waits. Of these none is left. That which is left waits.\n   Of course not. */\n",
     [(1, "sentence begins with 'Of'"), (1, "sentence begins with 'One that'"),
      (1, "sentence begins with 'That which'")]),
    ("what as a relative pronoun", "a.c", "/* Restore what the caller had. */\n",
     [(1, "'what' as a relative")]),
    ("what as an interrogative", "a.c", "/* The message says what is wrong. So what? */\n", []),
    ("the line of a word in a later line", "a.c", "/* Return the sum.\n   The table\n   tells it. */\n",
     [(3, "'tells'")]),
    ("a forbidden word in code and in quotes", "a.c",
     "/* Print `lies`, 'bite' or \"tell\"; see walk_tree, tell.c and fseek(). */\n", []),
    ("a term that contains a forbidden word", "a.c",
     "/* The letter n stands for electrons; off by one; error bars; intelligent, believe. */\n", []),
    ("a line comment", "a.c", 'char *s = "/* tells */"; // lies there\n', [(1, "'lies'")]),
    ("31 words", "a.c", "/* %s. */\n" % LONG, [(1, "sentence of 31 words")]),
    ("a semicolon between main clauses", "a.c", "/* %s; %s. */\n" % (FULL, FULL), []),
    ("30 words", "a.c", "/* %s. */\n" % FULL, []),
    ("30 words in each of two sentences and paragraphs", "a.c",
     "/* %s. %s.\n\n   %s\n\n   %s */\n" % ((FULL.capitalize(),) * 4), []),
    ("sentences that begin with code, or end in bold", "a.md",
     "**%s.** %s.\n`code` %s.\n" % (FULL.capitalize(), FULL.capitalize(), " ".join(["word"] * 29)),
     [(1, "line of ")] * 1 + [(2, "line of ")]),
    ("code in a comment", "a.c", "/* The record:\n\n       tells lies what\n\n   It ends. */\n", []),
    ("a summary", "a.c", 'x = {.summary = "what it "\n "lies in"};\ny = {.name = "what"};\n',
     [(1, "sentence begins with 'What'"), (2, "'lies'")]),
    ("a summary that begins with of", "a.c", 'x = {.summary = "of all layers"};\n',
     [(1, "sentence begins with 'Of'")]),
    ("the summary of a metric", "a.c", 'm[] = {{"bias", "%", OPC_LOWER, 0.1,\n "what tells"}};\n',
     [(2, "'tells'"), (2, "sentence begins with 'What'")]),
    ("a hash in shell", "a.sh", "#!/bin/sh\n# The tool tells a name.\necho 'lies' # no\n", [(2, "'tells'")]),
    ("comments and docstrings of Python", "a.py",
     'def f():\n    """Return it.\n\n    What is it."""\n    return "lies"  # tells\n',
     [(4, "sentence begins with 'What'"), (5, "'tells'")]),
    ("a command in a comment", "a.yaml",
     "# Run it, for example by\n#   opcflow run what.yaml --set lies=%s\n# and so on.\n" % LONG, []),
    ("Meson", "meson.build", "# What to build.\nproject('tells')\n", [(1, "sentence begins with 'What'")]),
    ("Markdown: code and tables are excepted", "a.md",
     "# Title\n\n```\nlies\n```\n\n    tells lies\n\n| what | lies |\n|---|---|\n\nText with `lies`.\n", []),
    ("Markdown: heading, list, paragraph", "a.md",
     "# What lies\n\n- One that waits\n  tells.\n- End\n\nA [link](what/lies.md) lies\nthere.\n",
     [(1, "'lies'"), (1, "sentence begins with 'What'"), (3, "sentence begins with 'One that'"),
      (4, "'tells'"), (7, "'lies'")]),
    ("Markdown: a line of 101 columns", "a.md", "%s\n\n%s\n" % ("ab " * 33 + "ab", "ab " * 32 + "abcd"),
     [(1, "line of 101 columns"), (1, "sentence of 34 words"), (3, "sentence of 33 words")]),
    ("declarations without a comment", "a.h",
     "#define A(x) \\\n  f(x)\n/* A point. */\ntypedef struct a {\n  int x;\n} a;\n\nint b(a p,\n      int q);\n\n"
     "enum { C };\ntypedef struct d d; /* a type */\n\n/* Sort.\n   Fast. */\nvoid e(void);\nint *f(void);\n\n"
     "OPC_UNUSED static inline int g(int x) {\n  return f(x);\n}\nstruct h {\n  int y;\n};\n",
     [(8, "'b' has no comment"), (11, "'enum' has no comment"), (19, "'g' has"), (22, "'h' has")]),
    ("Markdown: a long address", "a.md", "See [the page](%s).\n" % ("x" * 100), []),
]


def main():
    failed, number = 0, 0

    def report(name, fault):
        nonlocal failed, number
        number += 1
        failed += bool(fault)
        print("%sok %d - %s%s" % ("not " if fault else "", number, name, "\n#   %s" % fault if fault else ""))

    with tempfile.TemporaryDirectory(prefix="opcflow-prose-") as folder:
        for name, file, content, expected in CASES:
            path = os.path.join(folder, file)
            with open(path, "w") as f:
                f.write(content)
            found = prose.check(path)
            same = len(found) == len(expected) and all(
                a[0] == b[0] and a[1].startswith(b[1]) for a, b in zip(found, expected))
            report(name, "" if same else "found %s, expected %s" % (found, expected))
    done = subprocess.run([TOOL, "no-such-file"], capture_output=True, text=True)
    report("a path that does not exist", "" if done.returncode == 2 and "no-such-file" in done.stderr else done)
    print("1..%d" % number)
    return failed > 0


sys.exit(main())
