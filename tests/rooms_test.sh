#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Check the structure of the tree: which folders may include headers of which
# folders, and that the kernel contains no terms of the domain.
# rooms_test.sh [COMPILER...]
# OPCFLOW_SOURCE: source folder (default: the folder above this script).
set -u
cd "${OPCFLOW_SOURCE:-$(dirname "$0")/..}" || exit 99
[ $# -gt 0 ] || set -- "${CC:-cc}"
failed=0
number=0

# check NAME FUNCTION [WORD...]: run a check. FUNCTION prints a line for each fault.
check() {
  name=$1
  shift
  number=$((number + 1))
  wrong=$("$@")
  if [ -z "$wrong" ]; then
    echo "ok $number $name"
  else
    echo "not ok $number $name"
    echo "$wrong" | sed 's/^/# /'
    failed=1
  fi
}

# Print all includes of the files in the given folders, as "FROM/FILE INCLUDED". An INCLUDED path
# that begins with a dot is resolved.
includes() {
  find "$@" -name '*.[ch]' | sort | xargs grep -HE '^ *# *include *"' |
    sed 's/^\([^:]*\): *# *include *"\([^"]*\)".*/\1 \2/' |
    while read -r from to; do
      case $to in .*) to=$(realpath -m --relative-to=. "$(dirname "$from")/$to") ;; esac
      echo "$from $to"
    done
}

# Search domain words in code and texts, without comments. Each word also matches longer words.
domain_words() {
  echo | "$@" -E - >/dev/null || echo "no compiler: $*"
  find core tools/devel include -name '*.[ch]' ! -name '*_test.c' | sort | while read -r file; do
    # Names of POSIX that contain a domain word are excepted.
    "$@" -fpreprocessed -dD -E -P "$file" 2>/dev/null |
      sed -E 's/umask|sigmask|SETMASK//g' |
      grep -inE 'gate|transistor|mask|litho|resist|layout|poly' |
      sed "s|^|$file: |"
  done
}

# Print each include from a folder that is later in the list.
kernel_order() {
  includes core | awk '
    BEGIN { n = split("plugin binding report run cli", rooms, " ")
            for (i = 1; i <= n; i++) rank[rooms[i]] = i }
    { split($1, from, "/"); split($2, to, "/")
      if (to[1] != "core" || !(to[2] in rank) || !(from[2] in rank)) print
      else if ($1 !~ /_test\.c$/ && rank[to[2]] > rank[from[2]]) print }'
}

# Find cycles of calls among files of the kernel, by the symbols of the build. At most four files
# may form a cycle.
file_circles() {
  find "${OPCFLOW_BUILD:-build}/core" "${OPCFLOW_BUILD:-build}/opcflow.p" -name '*.c.o' ! -name '*_test.c.o' | sort |
    while read -r object; do
      name=$(basename "$object" .c.o)
      nm "$object" | sed "s|^|$name |"
    done | awk -v most=4 '
      $(NF-1) ~ /^[TDBRV]$/ { owner[$NF] = $1 }
      $(NF-1) == "U" { calls[$1 " " $NF] = 1 }
      END {
        for (c in calls) {
          split(c, f, " ")
          if (f[2] in owner && owner[f[2]] != f[1]) {
            reach[f[1], owner[f[2]]] = 1
            files[f[1]] = files[owner[f[2]]] = 1
          }
        }
        n = 0
        for (b in files) {
          n++
          for (a in files) if ((a, b) in reach)
            for (c in files) if ((b, c) in reach) reach[a, c] = 1
        }
        if (n < 20) print "only " n " files found: is the tree built?"
        for (a in files) {
          size = 0; names = ""
          for (b in files) if ((a, b) in reach && (b, a) in reach) {
            size++; names = names " " b
          }
          if (size > most) print a ": calls in a circle:" names
        }
      }'
}

# Check the size of the kernel. Lower the limit when the kernel becomes smaller.
kernel_size() {
  find core -name '*.[ch]' ! -name '*_test.[ch]' -exec cat {} + | wc -l |
    awk -v most=10000 '$1 > most { print "core has " $1 " lines of .c and .h, more than " most }'
}

# Includes of private headers give the path from the top of the library.
library_circles() {
  includes subprojects/eda | awk '
    { sub("subprojects/eda/", "", $1)
      split($1, from, "/"); n = split($2, to, "/")
      if (from[1] == "testing" || $1 ~ /_test\.[ch]$/) next
      if (n > 1 && to[1] != from[1]) edge[from[1] " " to[1]] = $1 " " $2 }
    END { for (e in edge) {
            split(e, f, " ")
            if ((f[2] " " f[1]) in edge) print edge[e] } }'
}

# <opcflow/base.h> is the only header that all share. Other headers of base are
# for the kernel and eda.
library_alone() {
  find subprojects/eda -name '*.[ch]' | sort |
    xargs grep -nE '^ *# *include *["<](core|plugins|opcflow)/' | grep -vF '<opcflow/base.h>'
  find core tools/devel subprojects/guard subprojects/ranks subprojects/store include -name '*.[ch]' ! -name '*_test.[ch]' | sort |
    xargs grep -nE '^ *# *include *["<](eda|plugins)/'
}

# A plugin includes from its folder or the shared files of its family. Tests may
# also include the test helpers of the kernel and of other tests.
families() {
  includes plugins | awk '
    { split($1, from, "/"); n = split($2, to, "/")
      if ($1 ~ /_test\.[ch]$/ && $2 ~ /^(core|tests|tools\/devel)\//) next
      if (n == 1) next
      if (to[1] == "plugins" ? to[2] != from[2] : 1) print }'
  find plugins -name '*.[ch]' ! -name '*_test.[ch]' | sort |
    xargs grep -nE '^ *# *include *<(core|plugins)/'
}

# The guard includes no header of other folders; the ranks include only result codes and errors.
guard_alone() {
  find subprojects/guard subprojects/ranks -name '*.[ch]' | sort |
    xargs grep -nE '^ *# *include *["<](core|eda|opcflow|plugins|tools)/' |
    grep -v '^subprojects/ranks/.*<opcflow/base\.h>$'
}

# The store includes only result codes and errors.
store_alone() {
  find subprojects/store -name '*.[ch]' | sort |
    xargs grep -nE '^ *# *include *["<](core|eda|opcflow|plugins|tools)/' |
    grep -v '<opcflow/base\.h>$'
}

# Print the id of each plugin, and the folder of the file that declares the id.
ids() {
  grep -rlE '^ *OPC_PLUGIN\(' plugins --include='*.c' | sort |
    while read -r file; do
      id=$(sed -n 's/.*\.id = "\([a-z0-9_.]*\)".*/\1/p' "$file")
      [ "plugins/$(echo "$id" | tr . /)" = "${file%/*}" ] || echo "$file: $id"
    done
}

# Print the files with too many lines.
long_files() {
  find core include subprojects plugins tests tools -type f |
    grep -E '\.(c|h|py|sh|inc)$' | sort | xargs wc -l |
    awk '$2 != "total" && $1 > 600 { print $2 ": " $1 " lines, more than 600" }'
}

# Each plugin has a test beside its code that makes the plugin by its id or
# links its code, and each test beside a plugin is built. The templates are tested
# by tests/new_test.c.
own_tests() {
  grep -rlE '^ *OPC_PLUGIN\(' plugins --include='*.c' | sort |
    while read -r file; do
      folder=${file%/*}
      id=$(sed -n 's/.*\.id = "\([a-z0-9_.]*\)".*/\1/p' "$file")
      grep -qsE "[\"/]$id[\"/]|opcflow_plugin|tests/inner\.h" "$folder"/*_test.[ch] ||
        echo "$folder: no *_test.c makes '$id'"
    done
  find plugins subprojects core -name '*_test.c' ! -path '*/examples/*' | sort |
    while read -r file; do
      grep -q "/$file\"" "${OPCFLOW_BUILD:-build}/compile_commands.json" || echo "$file: not built"
    done
}

# File-local functions named by a bare verb cannot be found by grep.
bare_verbs() {
  verbs=$(echo \
    add allocate annotate answer append apply ask begin bind blame borrow build call change check \
    choose claim clean clear clip collect collide compare complain complete compose contract copy \
    count cut deposit describe differ draw drop end enter evaluate exchange execute expect explore \
    extract fail fill find finish fit flatten flush follow forecast gather get go grow halve has \
    image include insert join judge keep leave list load look make match measure meet merge mirror \
    move multiply mutate need next note obey offer order own pair parse pass perform place plan \
    prepare print probe provide prune publish push put reach refine refuse renumber resize restore \
    reverse rule run same sample save say scale seek serve set settle share show shorten simulate \
    slice snap solve spend split spoil spread stamp start step stretch stroke swap sweep take \
    tie touch touches transform trim try turn understand unite update walk want warn weigh widen \
    work |
    tr ' ' '|')
  find core fuzz include plugins subprojects tools/devel -name '*.[ch]' ! -name '*_test.[ch]' | sort |
    xargs grep -nE "^(([^\"]* )?static .*[ *])?($verbs)\\("
}

base_alone() {
  find subprojects/base -name '*.[ch]' | sort |
    xargs grep -nE '^ *# *include *["<](core|plugins|opcflow|eda)/' | grep -vF '<opcflow/base.h>'
  find include plugins subprojects/eda/include subprojects/examples -name '*.[ch]' | sort |
    xargs grep -nE '^ *# *include *["<]base/'
}

echo "1..14"
check "the kernel has no domain word" domain_words "$@"
check "folders of the kernel include in one direction only" kernel_order
check "at most four files of the kernel form a cycle of calls" file_circles
check "the kernel stays small" kernel_size
check "the store includes no other folder" store_alone
check "includes of the library's folders form no cycle" library_circles
check "kernel and library include neither each other nor plugins" library_alone
check "guard and ranks include no other folder" guard_alone
check "plugins include from no other family" families
check "the path of a plugin's folder is its id" ids
check "base includes neither kernel nor library, and no plugin includes base" base_alone
check "no file has more than 600 lines" long_files
check "each plugin has a test that is built" own_tests
check "no file-local function is named by a bare verb" bare_verbs
exit $failed
