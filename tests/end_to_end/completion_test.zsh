#!/usr/bin/env zsh
# What the tabulator key makes of a line in an interactive zsh, in a folder with one run:
#     completion_test.zsh TCHAT LINOSC.so CONSTANTS COMPLETION
setopt err_exit no_unset pipe_fail
zmodload zsh/zpty
tchat=${1:A} linosc=${2:A} constants=${3:A} completion=${4:A}
folder=$(mktemp -d)
trap 'rm -rf $folder' EXIT
cd $folder
mkdir bin functions
ln -s $tchat bin/tchat
ln -s $completion functions/_tchat
path=($folder/bin $path)
cp $linosc linosc.so
cp $constants/* .
tchat run linosc -q -c to_grazing -d nonimpacting -o grazing

# A shell whose key ^I completes the line and whose key ^X shows it.
cat >.zshrc <<'END'
PS1= ; unsetopt beep prompt_cr prompt_sp zle_bracketed_paste 2>/dev/null
fpath=($PWD/functions $fpath)
autoload -Uz compinit && compinit -u -D
show_line() { print -r -- "<line>$BUFFER</line>"; BUFFER= }
zle -N show_line
bindkey '^I' complete-word '^X' show_line
print '<ready>'
END
export TERM=dumb ZDOTDIR=$folder
zpty shell zsh -i || { print 'no pseudo terminal'; exit 77 }
zpty -r -m shell answer '*<ready>*'

failed=0
# becomes LINE EXPECTED
becomes() {
  local answer
  zpty -w -n shell "$1"$'\t\x18'
  zpty -r -m shell answer '*<line>*</line>*'
  answer=${${answer##*<line>}%%</line>*}
  [[ $answer == "$2" ]] && return
  print "'$1' became '$answer', expected '$2'"
  failed=1
}
becomes 'tchat ru' 'tchat run '
becomes 'tchat rese' 'tchat resegment '
becomes 'tchat orbit q.grazing G' 'tchat orbit q.grazing GR1 '
becomes 'tchat run linosc -s grazing IRS=G' 'tchat run linosc -s grazing IRS=GR1 '
becomes 'tchat run linosc -s grazing DSM' 'tchat run linosc -s grazing DSM'
becomes 'tchat run linosc -s grazing NTS' 'tchat run linosc -s grazing NTST='
becomes 'tchat run linosc --str' 'tchat run linosc --strict '
becomes 'tchat labels q.g' 'tchat labels q.grazing '
becomes 'tchat nothing_of_the_kind x' 'tchat nothing_of_the_kind x'
zpty -d shell
exit $failed
