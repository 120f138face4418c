# Bash completion for ct2model, sphsolve and analyze. It asks the programs themselves, so that it is never out of date:
# commands and options from --help, values from what stands behind an option there (a|b|c), keys of a scene and their
# values from what the scene's reader says of a wrong one.
_tosui_scene() { # PROGRAM SCENE PATH[=VALUE]: what may stand there
  local said path=${3%%=*} parent
  if [[ $3 == *=* ]]; then
    said=$("$1" explain "$2" --set "$path=?" 2>&1)
    case $said in
      *"is none of"*) grep -oE '"[a-z0-9_-]+"' <<< "${said##*is none of}" | tr -d '"' | sed "s|^|$path=|" ;;
      *"true or false"*) printf '%s\n' "$path=true" "$path=false" ;;
    esac
  else
    parent=${path%"${path##*.}"}
    said=$("$1" explain "$2" --set "${parent}zzqq=1" 2>&1)
    [[ $said == *"known here: "* ]] || return
    if [ -n "$parent" ]; then
      tr -d ' ' <<< "${said##*known here: }" | tr ',' '\n' | sed "s|^|$parent|; s|$|=|"
    else
      tr -d ' ' <<< "${said##*known here: }" | tr ',' '\n' | sed 's|$|.|'
    fi
  fi
}
_tosui() {
  local program=${COMP_WORDS[0]} command=${COMP_WORDS[1]} line=${COMP_LINE:0:COMP_POINT} word before help values
  word=${line##*[[:space:]]} # '=' parts words for bash
  before=${line%"$word"}
  before=${before%"${before##*[![:space:]]}"}
  before=${before##*[[:space:]]}
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "$("$program" --help 2>/dev/null | sed -n '/^Commands:/,/^$/s/^  \([a-z0-9]*\) .*/\1/p') --help --version" -- "$word"))
    return
  fi
  help=$("$program" "$command" --help 2>/dev/null)
  if [[ $word == -* ]]; then
    COMPREPLY=($(compgen -W "$(grep -oE -- '--[a-z][a-z-]*' <<< "$help" | sort -u)" -- "$word"))
    return
  fi
  if [[ $before == --set || $before == -s ]]; then
    local scene
    for scene in "${COMP_WORDS[@]:2}"; do [[ $scene == *.cfg && -r $scene ]] && break; done
    [[ $scene == *.cfg ]] || return
    COMPREPLY=($(compgen -W "$(_tosui_scene "$program" "$scene" "$word")" -- "$word"))
    [[ ${COMPREPLY[0]} == *[.=] ]] && compopt -o nospace 2>/dev/null
    [[ $word == *=* ]] && COMPREPLY=("${COMPREPLY[@]#*=}")
    return
  fi
  if [[ $before == -* ]]; then
    # "  -x, --name a|b|c   help": lower-case words between bars are values.
    values=$(sed -nE "s/^ +(-[a-z], )?$before ([^ ]+)( .*)?$/\2/p; s/^ +$before, --[a-z-]+ ([^ ]+)( .*)?$/\1/p" <<< "$help" | head -1)
    [[ $values == *'|'* ]] &&
      COMPREPLY=($(compgen -W "$(tr -d '[]' <<< "$values" | tr '|' '\n' | grep -E '^[a-z0-9-]+$')" -- "$word"))
    [ ${#COMPREPLY[@]} -gt 0 ] && return
  fi
  # A name a line, for some have spaces; what is quoted is left to readline.
  compopt -o filenames 2>/dev/null # not for keys: their '=' would be quoted
  [[ ${COMP_WORDS[COMP_CWORD]} == *[\\\"\']* ]] || mapfile -t COMPREPLY < <(compgen -f -- "$word")
}
complete -o default -F _tosui ct2model sphsolve analyze
