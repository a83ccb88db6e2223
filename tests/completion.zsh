# SPDX-License-Identifier: BSD-3-Clause
# Complete command lines by zsh, which runs on a pseudo-terminal in the current folder.
# Reads lines from standard input and presses Tab at the end of each line. Prints the
# completed line, '|', and the sorted candidates. OPCFLOW_SOURCE is the folder of the
# sources, which has the completion; OPCFLOW_BUILD is the folder of the command.
zmodload zsh/zpty zsh/zselect
here=$PWD/.zsh-completion
mkdir -p $here
print -r -- "
PS1= PS2= RPS1=
unsetopt beep
path=(${(q)OPCFLOW_BUILD} \$path)
fpath=(${(q)OPCFLOW_SOURCE}/data/completion \$fpath)
autoload -Uz compinit
compinit -u -D
compadd() {
  local -a offers
  builtin compadd -O offers \"\$@\"
  (( \$#offers )) && print -rl -- \$offers >> ${(q)here}/offers
  builtin compadd \"\$@\"
}
show_line() { print -r -- \"\$BUFFER\" > ${(q)here}/line; BUFFER= }
zle -N show_line
bindkey '^X' show_line
bindkey '^I' complete-word
LISTMAX=100000
print ready > ${(q)here}/line
" > $here/rc
# Wait for at most ten seconds. Output of the shell is discarded, because a full terminal buffer
# would block the shell.
wait_for_line() {
  local -i n
  local junk
  for (( n = 0; n < 1000; n++ )); do
    while zpty -r -t shell junk; do :; done
    [[ -s $here/line ]] && return
    zselect -t 1
  done
  print "no answer of zsh within 10 s"
  exit 1
}
zpty shell "TERM=dumb zsh -f -i"
zpty -w shell "source ${(q)here}/rc"
wait_for_line
while IFS= read -r line; do
  rm -f $here/offers $here/line
  zpty -w -n shell $line$'\t\x18'
  wait_for_line
  offers=()
  [[ -f $here/offers ]] && offers=(${(ou)${(f)"$(<$here/offers)"}})
  print -r -- "$(<$here/line)|$offers"
done
zpty -d shell
rm -rf $here
