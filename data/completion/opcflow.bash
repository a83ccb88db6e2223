# SPDX-License-Identifier: BSD-3-Clause
# bash completion of opcflow: the command itself knows what may come.
_opcflow() {
  mapfile -t COMPREPLY < <("${1/#\~/$HOME}" complete -- "${COMP_LINE:0:COMP_POINT}" 2>/dev/null)
  if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *[=/] ]]; then
    compopt -o nospace 2>/dev/null
  fi
}
complete -o default -F _opcflow opcflow
