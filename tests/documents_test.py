#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test the examples and the links of the documents.

A block that begins with `opcflow: 1` is a flow. The test checks the flow; if the next block
has lines `NAME.yaml:LINE:COLUMN: ...`, the check must report exactly these. In docs/tutorial,
the test runs blocks marked `sh` one after another in one folder, after it has written blocks
marked `yaml NAME`. A block marked `text` lists lines that the commands before it must print,
in this order; `...` matches any text. Relative links must name a file and a heading that exist.
The gallery must show each picture that a question of tools/results makes, and no other.
"""
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
OPCFLOW = os.path.join(os.environ["OPCFLOW_BUILD"], "opcflow")


def blocks(path):
    """Yield (line, mark, text) of each fenced block and of each indented flow."""
    with open(path) as f:
        lines = f.read().split("\n")
    i = 0
    while i < len(lines):
        fence = re.match(r"(```+)(.*)", lines[i])
        if fence:
            end = lines.index(fence[1], i + 1)
            yield i + 1, fence[2].strip(), "\n".join(lines[i + 1:end]) + "\n"
            i = end
        elif lines[i] == "    opcflow: 1":
            end = next(k for k in range(i, len(lines)) if lines[k] and not lines[k].startswith("    "))
            yield i + 1, "yaml", "\n".join(line[4:] for line in lines[i:end]) + "\n"
            i = end - 1
        i += 1


def room():
    """Make a folder in which file names of flows are valid as in the source folder."""
    folder = tempfile.mkdtemp(prefix="opcflow-documents-")
    for name in ("flows", "data"):
        os.symlink(os.path.join(ROOT, name), os.path.join(folder, name))
    # Shipped flows, and flows of documents that are similar, name files relative to flows/.
    os.mkdir(os.path.join(folder, "here"))
    for flow in glob.glob(os.path.join(ROOT, "flows", "*.yaml")):
        os.symlink(flow, os.path.join(folder, "here", os.path.basename(flow)))
    return folder


def ask(words, folder, **more):
    return subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, **more)


def check_flow(text, expected):
    """Return the faults of a flow of a document; '' if they equal those of the document."""
    named = re.match(r"([\w-]+\.yaml):\d+", expected)
    folder = room()
    try:
        place = "." if "flows/" in text else "here"
        name = os.path.join(place, named[1] if named else "its-flow.yaml")
        with open(os.path.join(folder, name), "w") as f:
            f.write(text)
        said = ask([OPCFLOW, "check", os.path.basename(name)], os.path.join(folder, place))
    finally:
        shutil.rmtree(folder)
    if not named:
        return "" if said.returncode == 0 else said.stdout
    # The command also prints a forecast.
    faults = [line for line in said.stdout.split("\n") if re.match(r"[\w./-]+:\d+:", line)]
    return "" if faults == expected.strip().split("\n") else said.stdout


def like(expected, said):
    """Return the first line of `expected` that `said` lacks, in this order; None: all lines exist."""
    rest = said.split("\n")
    for line in filter(None, expected.split("\n")):
        if line.strip() == "...":
            continue
        pattern = ".*".join(re.escape(part.strip()) for part in line.split("..."))
        while rest and not re.search(re.sub(r"(\\ )+", r"\\s+", pattern), rest[0]):
            rest.pop(0)
        if not rest:
            return line
        rest.pop(0)
    return None


class Report:
    def __init__(self):
        self.number, self.failed = 0, 0

    def record(self, name, fault):
        self.number += 1
        self.failed += bool(fault)
        print("%sok %d - %s" % ("not " if fault else "", self.number, name))
        for line in (fault or "").strip().split("\n"):
            if line:
                print("#   " + line)
        sys.stdout.flush()


def documents(*begins):
    """Return the paths of all Markdown files whose names begin with one of `begins`."""
    names = []
    for folder, folders, files in os.walk(ROOT):
        folders[:] = [f for f in folders if not f.startswith((".", "build"))
                      and f != "runs"]
        names += [os.path.relpath(os.path.join(folder, f), ROOT) for f in files if f.endswith(".md")]
    return [os.path.join(ROOT, name) for name in sorted(names) if name.startswith(begins)]


def without_code(path):
    """Return the text of a document without its fenced blocks and `code`."""
    with open(path, encoding="utf-8") as f:
        text = re.sub(r"^(```+).*?^\1$", "", f.read(), flags=re.M | re.S)
    return re.sub(r"`[^`\n]*`", lambda m: "x" * len(m[0]), text)


def anchors(path):
    """Return the anchors of a document's headings, as GitHub and GitLab make them."""
    with open(path, encoding="utf-8") as f:
        text = re.sub(r"^(```+).*?^\1$", "", f.read(), flags=re.M | re.S)
    found = re.findall(r"^#+ +(.*?) *$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", re.sub(r"\]\([^)]*\)", "]", h).lower()).replace(" ", "-") for h in found}


def try_links(report):
    """Test that relative links of all documents lead to a file and a heading."""
    for path in documents(""):
        faults = []
        for target in re.findall(r"\]\(([^)\s]+)\)", without_code(path)):
            if re.match(r"[a-z]+:", target):
                continue
            name, _, heading = target.partition("#")
            file = os.path.normpath(os.path.join(os.path.dirname(path), name)) if name else path
            if not os.path.exists(file):
                faults.append("no such file: " + target)
            elif heading and heading not in anchors(file):
                faults.append("no such heading: " + target)
        report.record("links of " + os.path.relpath(path, ROOT), "\n".join(faults))


def try_flows(report):
    for path in documents("README.md", "docs/"):
        found = list(blocks(path))
        for k, (line, mark, text) in enumerate(found):
            if not mark.startswith("yaml") or len(mark.split()) > 1 or not re.search("^opcflow: 1", text, re.M):
                continue
            expected = found[k + 1][2] if k + 1 < len(found) else ""
            report.record("%s:%d" % (os.path.relpath(path, ROOT), line), check_flow(text, expected))


def try_tutorial(report, path):
    folder = tempfile.mkdtemp(prefix="opcflow-tutorial-")
    path_of = "%s:%s" % (os.path.dirname(os.path.abspath(OPCFLOW)), os.environ["PATH"])
    env = {**os.environ, "PATH": path_of, "OPCFLOW_TOP": ROOT, "OPCFLOW_STORE": os.path.join(folder, ".store")}
    said = ""
    try:
        for line, mark, text in blocks(path):
            name, fault = "%s:%d" % (os.path.relpath(path, ROOT), line), None
            if len(mark.split()) == 2:
                with open(os.path.join(folder, mark.split()[1]), "w") as f:
                    f.write(text)
                continue
            if mark == "sh":
                answer = ask(["sh", "-ec", text], folder, env=env)
                said = answer.stdout
                # A command that is expected to fail ends in `|| echo "exit code $?"`.
                fault = answer.returncode and "exit code %d\n%s" % (answer.returncode, said)
            elif mark == "text":
                missing = like(text, said)
                fault = missing and "not said: %s\nsaid:\n%s" % (missing, said)
            else:
                continue
            report.record(name, fault)
    finally:
        shutil.rmtree(folder)


def try_site(report):
    """Make the site: mkdocs reports links without a target. All links between the pages must
    name a file, and each document has a page."""
    if not shutil.which("mkdocs"):
        report.record("site # SKIP mkdocs is not installed", "")
        return
    with tempfile.TemporaryDirectory(prefix="opcflow-site-") as folder:
        said = ask([os.path.join(ROOT, "tools", "site"), folder], ROOT)
        faults = said.stdout if said.returncode else ""
        pages = glob.glob(os.path.join(folder, "**", "*.html"), recursive=True)
        for page in pages:
            with open(page) as f:
                links = re.findall(r'(?:href|src)="([^"#?]+)', f.read())
            for link in links:
                target = os.path.join(os.path.dirname(page), link)
                if ":" not in link and not link.startswith("/") and not os.path.exists(target):
                    faults += "%s: no file '%s'\n" % (os.path.relpath(page, folder), link)
        for path in documents("docs/", "plugins/"):
            name = os.path.relpath(path, ROOT)[:-len(".md")].replace("README", "index") + ".html"
            if not os.path.exists(os.path.join(folder, name)):
                faults += "no page of %s\n" % name
    report.record("site", faults)


def try_requirements(report):
    """Test that flows whose result is a mask allow no violations of mask rules beyond the drawing."""
    missing = []
    for name in ("chip", "demo", "dpb", "epe", "given", "newton", "window", "scanners/correct"):
        with open(os.path.join(ROOT, "flows", name + ".yaml")) as f:
            if "mask.mask_violations_added: 0\n" not in f.read():
                missing.append(name)
    report.record("shipped flows require masks without added violations", ", ".join(missing))


def main():
    report = Report()
    try_requirements(report)
    try_flows(report)
    try_links(report)
    try_site(report)
    said = ask([os.path.join(ROOT, "tools", "results"), "--gallery"], ROOT)
    report.record("pictures of the gallery", said.returncode and said.stdout)
    for path in documents("docs/tutorial/"):
        try_tutorial(report, path)
    print("1..%d" % report.number)
    return report.failed > 0


sys.exit(main())
