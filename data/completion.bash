# Completes commands, flags and their words in bash, by what the program says of itself.
_vesalius() {
  local program=${COMP_WORDS[0]} command=${COMP_WORDS[1]} current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  local help words='' options=''
  if [[ $COMP_CWORD -eq 1 ]]; then
    help=$("$program" --help 2>/dev/null)
    words=$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z0-9]*\) .*/\1/p' <<<"$help")
  else
    help=$("$program" "$command" --help 2>/dev/null)
    [[ $before != -* || $before == */* ]] || words=$(sed -n "s/^  \(.*,\)\?$before [^ ]*{\([^}]*\)}.*/\2/p" <<<"$help")
    if [[ $words ]]; then
      COMPREPLY=($(compgen -W "${words//,/ }" -- "$current"))
      return
    fi
    words=$(sed -n 's/^  [A-Z]* [^ ]*{\([^}]*\)}.*/\1/p' <<<"$help")
    case $command in
    detect | bench | evaluate | record | ros2 | view) options=detect ;;
    synth | train) options=$command ;;
    esac
    # --help leaves out the options that a file can hold.
    [[ ! $options ]] || words+=" $("$program" options $options 2>/dev/null |
      sed -n 's/^\([a-z][a-z0-9.-]*\) = .*/--\1/p')"
  fi
  words+=" $(grep -oE '^  -[^ {]+' <<<"$help")"
  COMPREPLY=($(compgen -W "${words//,/ }" -- "$current"))
  [[ $COMP_CWORD -eq 1 || $current == -* ]] || COMPREPLY+=($(compgen -f -- "$current"))
}
complete -o filenames -F _vesalius vesalius
