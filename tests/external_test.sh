#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Install this build into a separate folder and move the installation. Build,
# test and install the project subprojects/examples against the installation,
# through pkg-config alone. Then run a flow with the installed plugins.
# OPCFLOW_SOURCE, OPCFLOW_BUILD: source and build folder; $1: command meson; $2:
# value of the option b_sanitize.
set -eu
meson=$1
sanitize=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
unset LD_LIBRARY_PATH OPCFLOW_PLUGIN_PATH XDG_DATA_HOME DESTDIR PKG_CONFIG_LIBDIR || true
# Use no files of another installation or of the user.
export HOME="$work/home" XDG_DATA_HOME="$work/home/data"

fail() {
  echo "$*" >&2
  exit 1
}

# Run a command; show the output of the command only if it fails.
try() {
  "$@" >"$work/log" 2>&1 || { cat "$work/log" >&2; fail "failed: $*"; }
}

try "$meson" install -C "$OPCFLOW_BUILD" --no-rebuild --destdir "$work/staged"
pc=$(find "$work/staged" -name opcflow.pc)
[ -n "$pc" ] || fail "opcflow.pc is not installed"
lib=$(dirname "$(dirname "$pc")")
staged=$(dirname "$lib")
[ -x "$staged/bin/opcflow" ] || staged=$(dirname "$staged")
mv "$staged" "$work/moved"
rm -rf "$work/staged"
export PKG_CONFIG_PATH="$work/moved/${lib#"$staged"/}/pkgconfig"
opcflow=$(pkg-config --variable=command opcflow)
[ "$(realpath "$opcflow")" = "$(realpath "$work/moved/bin/opcflow")" ] ||
  fail "pkg-config says that the command is $opcflow"

# The moved command must find the moved plugins, and the plugins the moved
# library.
unset OPCFLOW_NO_SYSTEM_PLUGINS
"$opcflow" inspect synthesizer.dpb | grep -q "^$work/moved/" ||
  fail "$opcflow does not find its own plugins"
[ -z "$("$opcflow" plugins --failed)" ] || fail "$("$opcflow" plugins --failed)"

# Test the installed documents and examples. A command in the README builds one
# plugin without meson.
documents=$(find "$work/moved" -type d -path '*/doc/opcflow')
[ -f "$documents/guides/plugin.md" ] || fail "the plugin guide is not installed"
cp -r "$documents/examples" "$work/project"
cp -r "$documents/examples" "$work/alone"
sed -n '/^    cc /,/-lm$/p' "$work/alone/README.md" >"$work/line"
(cd "$work/alone" && try sh -e "$work/line")
try "$opcflow" lint --strict "$work/alone/synthesizer.bisect.so"
try "$opcflow" inspect synthesizer.bisect --plugin-path "$work/alone"

try "$meson" setup "$work/build" "$work/project" --prefix "$work/private" \
  -Dplugins="$work/private/plugins" -Db_sanitize="$sanitize" -Db_lundef=false
try ninja -C "$work/build"
try env OPCFLOW_NO_SYSTEM_PLUGINS=1 "$meson" test -C "$work/build" --no-rebuild -t 10
[ "$(grep -c ' OK ' "$work/log")" = 4 ] || { cat "$work/log"; fail "not 4 tests"; }
try "$meson" install -C "$work/build" --no-rebuild

# Use the plugins in the private folder, not those of the build.
mv "$work/build" "$work/gone"
export OPCFLOW_PLUGIN_PATH="$work/private/plugins"
try "$work/project/run.sh" "$opcflow" "$work/project/flow.yaml" "$work/run"
grep -q "$work/private/plugins/synthesizer.bisect.so" "$work/run/manifest.json" ||
  fail "synthesizer.bisect is not the installed one"
[ -z "$("$opcflow" plugins --failed)" ] || fail "$("$opcflow" plugins --failed)"
"$opcflow" help | grep -q '^  metrics .*side by side' ||
  fail "the verb of command.metrics is not listed"

# Create a plugin of the kind that the project defines.
"$opcflow" new plugin timing.mine "$work/mine" >&2
try env PKG_CONFIG_PATH="$PKG_CONFIG_PATH" CFLAGS="-I$work/private/include" \
  "$meson" setup "$work/built" "$work/mine" -Db_sanitize="$sanitize" -Db_lundef=false
try ninja -C "$work/built"
try "$opcflow" lint "$work/built/timing.mine.so"
try "$opcflow" run --plugin-path "$work/built" --output "$work/mine/run" \
  --set delays.timing.use=timing.mine "$work/project/flow.yaml"
