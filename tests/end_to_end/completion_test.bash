#!/usr/bin/env bash
# What bash offers at the cursor, in a folder with one run:
#     completion_test.bash TCHAT LINOSC.so CONSTANTS COMPLETION
# Words are split as bash splits them, at = and : too.
set -euo pipefail
tchat=$(realpath "$1") linosc=$(realpath "$2") constants=$(realpath "$3") completion=$(realpath "$4")
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
mkdir bin
ln -s "$tchat" bin/tchat
PATH=$folder/bin:$PATH
cp "$linosc" linosc.so
cp "$constants"/* .
tchat run linosc -q -c to_grazing -d nonimpacting -o grazing
# shellcheck source=/dev/null
source "$completion"

set +e # outside of completion compopt fails
failed=0
# offers "EXPECTED WORDS" WORD...: the cursor is behind the last word.
offers() {
  local expected=$1
  shift
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _tchat
  [[ ${COMPREPLY[*]} == "$expected" ]] && return
  echo "after '$*': offered '${COMPREPLY[*]}', expected '$expected'"
  failed=1
}
offers "run" tchat ru
offers "resegment" tchat rese
offers "1 2 EP1 GR1" tchat orbit q.grazing ''
offers "GR1" tchat orbit q.grazing G
offers "1 2 EP1 GR1" tchat run linosc -s grazing IRS =
offers "GR1" tchat run linosc -s grazing IRS = G
offers "DS= DSMAX= DSMIN=" tchat run linosc -s grazing D
offers "--strict" tchat run linosc --str
offers "q.grazing" tchat labels q.g
offers "" tchat nothing_of_the_kind ''
exit "$failed"
