# Completion of tchat for bash. What can stand at the cursor is known to `tchat complete`.
_tchat() {
  local word words=() index=0 offset=''
  # Bash splits words at = and :, which tchat does not.
  for word in "${COMP_WORDS[@]:1:COMP_CWORD}"; do
    index=$((index + 1))
    if ((${#words[@]})) && [[ $word == [=:]* || ${words[-1]} == *[=:] && ${COMP_WORDS[index - 1]} == [=:]* ]]; then
      words[-1]+=$word
    else
      words+=("$word")
    fi
  done
  ((${#words[@]})) || words=('')
  words=("${words[@]//\\/}") # what bash has escaped is plain for the program
  if [[ ${words[-1]} == *=* ]]; then offset=${words[-1]%%=*}=; fi
  COMPREPLY=()
  while IFS= read -r word; do
    word=${word#"$offset"}
    COMPREPLY+=("$(printf '%q' "$word")")
    if [[ $word == *[=/] ]]; then compopt -o nospace 2>/dev/null; fi
  done < <("${COMP_WORDS[0]}" complete -- "${words[@]}" 2>/dev/null)
}
complete -F _tchat tchat
