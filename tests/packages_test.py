#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Test the files of Debian packages (debian/): each installed file is in one package, each
pattern names a file, and the versions are those of the project."""
import fnmatch
import glob
import json
import os
import re
import subprocess
import sys

BUILD, SOURCE = os.environ["OPCFLOW_BUILD"], os.environ["OPCFLOW_SOURCE"]


def introspect(what):
    return json.loads(subprocess.run(["meson", "introspect", what, BUILD], check=True,
                                     stdout=subprocess.PIPE).stdout)


def installed(prefix):
    """Return the installed paths, relative to the root folder of Debian's packages."""
    paths = []
    for source, to in introspect("--installed").items():
        inside = [os.path.relpath(os.path.join(folder, name), source)
                  for folder, _, names in os.walk(source) for name in names]
        paths += [os.path.join(to, name) for name in inside] or [to]
    libraries = {os.path.basename(p) for p in paths if re.search(r"/lib[^/]*\.so\.\d+$", p)}
    paths += [re.sub(r"\.so\.\d+$", ".so", p) for p in paths if os.path.basename(p) in libraries]
    found = {re.sub("^" + re.escape(prefix), "usr", p) for p in paths}
    # debian/rules moves the Python package.
    return {re.sub("^usr/lib/.*/opcflow/python/", "usr/lib/python3/dist-packages/", p)
            for p in found}


def patterns():
    """Yield (package, pattern)."""
    for path in glob.glob(os.path.join(SOURCE, "debian", "*.install")):
        with open(path) as f:
            for line in f.read().split():
                yield os.path.basename(path)[:-len(".install")], line


def holds(pattern, path):
    """Return whether a pattern names the path or one of its folders; * is a part of one name."""
    parts, names = pattern.split("/"), path.split("/")
    return len(parts) <= len(names) and all(map(fnmatch.fnmatchcase, names, parts))


def faults():
    options = {o["name"]: o["value"] for o in introspect("--buildoptions")}
    version = introspect("--projectinfo")["version"]
    paths, all_patterns = installed(options["prefix"]), list(patterns())
    for path in sorted(paths):
        owners = [package for package, pattern in all_patterns if holds(pattern, path)]
        if len(owners) != 1:
            yield "%s is in %s, expected one package" % (path, owners or "no package")
    for package, pattern in all_patterns:
        if not any(holds(pattern, path) for path in paths):
            yield "%s: nothing installed matches %s" % (package, pattern)
    with open(os.path.join(SOURCE, "debian", "changelog")) as f:
        if not f.read().startswith("opcflow (%s)" % version):
            yield "debian/changelog: expected version %s" % version
    with open(os.path.join(SOURCE, "debian", "control")) as f:
        names = set(re.findall(r"^Package: (\S+)", f.read(), re.M))
    if names != {package for package, _ in all_patterns}:
        yield "debian/control: expected the packages of debian/*.install, found %s" % names


def main():
    if not any(os.access(os.path.join(p, "meson"), os.X_OK) for p in os.get_exec_path()):
        print("1..1\nok 1 packages # SKIP meson is not in the PATH")
        return 0
    found = list(faults())
    print("1..1\n%sok 1 packages" % ("not " if found else ""))
    for line in found:
        print("# " + line)
    return len(found) > 0


sys.exit(main())
