# bash completion for rmlcell. Installed as share/bash-completion/completions/rmlcell; or: source this file.
# Needs nothing but bash. Names of machines, programs, projects and jobs come from the server, when one
# answers within a second. tests/structure/completion_test.py compares it with `rmlcell --help`.

# Adds the words that begin with what is typed.
_rmlcell_offer() {
  local word
  for word in "$@"; do
    [[ $word == "$cur"* ]] && COMPREPLY+=("$word")
  done
}

# Files whose name ends with one of the patterns, in capitals or not, and folders; no pattern: all files.
_rmlcell_files() {
  local file pattern
  compopt -o filenames 2>/dev/null
  while IFS= read -r file; do
    if [[ -d $file ]]; then
      COMPREPLY+=("$file")
      continue
    fi
    [[ $# -eq 0 ]] && COMPREPLY+=("$file")
    for pattern in "$@"; do
      [[ ${file,,} == *"$pattern" ]] && COMPREPLY+=("$file") && break
    done
  done < <(compgen -f -- "$cur")
}

_rmlcell_programs_files() { _rmlcell_files .s .si .cmp .o .rml .prn; }

# First column of a table that the server answers with, without its head.
_rmlcell_ask() {
  RMLCELL_SERVER=${server:-${RMLCELL_SERVER:-}} timeout 1 "${COMP_WORDS[0]}" "$@" 2>/dev/null |
    sed -e 1d -e 's/ .*//'
}

_rmlcell_machines() { _rmlcell_offer $(_rmlcell_ask machines); }
_rmlcell_projects() { _rmlcell_offer $(_rmlcell_ask projects); }
_rmlcell_slots() { _rmlcell_offer $(_rmlcell_ask programs "$1"); }
_rmlcell_jobs() { _rmlcell_offer $(_rmlcell_ask jobs --limit 50 ${1:+--filter "$1"}); }
_rmlcell_artifacts() {
  _rmlcell_offer $(RMLCELL_SERVER=${server:-${RMLCELL_SERVER:-}} timeout 1 "${COMP_WORDS[0]}" job "$1" 2>/dev/null |
    sed -n 's/^product *\([^ ]*\).*/\1/p')
}

# Codes and symbols of the catalogue: OPT-E348, HOLE_RADIUS_ZERO.
_rmlcell_codes() {
  _rmlcell_offer $("${COMP_WORDS[0]}" explain 2>/dev/null | sed -E 's/^([^ ]+)  ([A-Z0-9_]+):.*/\1 \2/')
}

# Options of a verb.
_rmlcell_options() {
  local remote="--help --server --json"
  case $1 in
    "") echo "--help --version" ;;
    check) echo "--help --family --profile --machine --origin --clamps --inputs --errors-only --fix --dry-run --machine-coordinates --strict --json" ;;
    simulate)
      echo "--help --slot --main --executable --family --profile --machine --origin --clamps --inputs --mode --override --simul" \
        "--break --budget --vars --svg --toolpath --samples --plot --stock --tool --cell --material --rpm --stl" \
        "--stl-tolerance --relief --height-map --target --target-tolerance --target-png" \
        "--state-in --state-out --trace --facts --machine-coordinates --strict --json" ;;
    explain) echo "--help --json" ;;
    diff) echo "--help --profile --machine --svg --json" ;;
    rml1) echo "--help" ;;
    "rml1 explain") echo "--help --profile --machine --origin --json" ;;
    "rml1 to-gcode") echo "--help --profile --machine --origin --output --force --json" ;;
    "rml1 from-gcode") echo "--help --profile --machine --origin --output --force --json --tolerance" ;;
    "rml1 move") echo "--help --profile --machine --origin --by --output --force --json" ;;
    "rml1 steps") echo "--help --profile --machine --origin --from --to --output --force --json" ;;
    "rml1 tile") echo "--help --profile --machine --origin --columns --rows --within --gap --output --force --json" ;;
    "rml1 from-png")
      echo "--help --profile --machine --origin --tool --depth --step --passes --overlap --outline --dpi --at --feed" \
        "--plunge --rpm --clearance --tolerance --invert --output --force --json" ;;
    parameters) echo "--help --profile --json" ;;
    compile) echo "--help --map --output --json" ;;
    decompile | compensate | list) echo "--help --output --json" ;;
    link) echo "--help --slot --main --output --json" ;;
    format) echo "--help --check --json" ;;
    convert) echo "--help --output --json" ;;
    lsp) echo "--help --stdio" ;;
    transform) echo "--help --move --turn --shift --output --json" ;;
    machines | programs | delete | stale | projects | job | cancel | hold | resume) echo "$remote" ;;
    move) echo "$remote --before --priority" ;;
    put) echo "$remote --etag --check-only --force" ;;
    special) echo "$remote --replace" ;;
    get) echo "$remote --form --output" ;;
    submit)
      echo "$remote --slot --kind --unzeroed --ticket --step --occurrence --off-until-work-on --seen --title --label --request-id --override --pace --inputs --stock --tool --cell --material --rpm --target --target-slot --target-tolerance --products --stl-tolerance --project --trace --priority --hold --not-before --after-job --watch --strict" ;;
    machine) echo "$remote" ;;
    "machine status" | "machine watch" | "machine enable" | "machine disable" | "machine hold" | "machine stop" | \
      "machine emergency-stop" | "machine abort" | "machine read") echo "--help" ;;
    "machine start-at")
      echo "--help --take-over --slot --occurrence --direct --off-until-work-on --stock --tool --untouched --preview --halt --no-halt --seen --reason" ;;
    "machine log") echo "--help --follow" ;;
    "machine taught") echo "--help --take-over --slot --undo" ;;
    "machine key") echo "--help --take-over --for --fast" ;;
    "machine start") echo "--help --take-over --job --seen" ;;
    "machine options") echo "--help" ;;
    "machine take") echo "--help --reason --computer" ;;
    "machine resume") echo "--help --take-over --accept-displaced --restore-process" ;;
    "machine "*) echo "--help --take-over" ;;
    report) echo "$remote --machine-coordinates" ;;
    watch) echo "$remote --after --strict" ;;
    jobs) echo "$remote --filter --order --limit" ;;
    picture | artifact) echo "$remote --output" ;;
    handbox) echo "--help --take-over --server" ;;
    replay) echo "--help --server --from --to --output" ;;
    "projects list" | "projects show" | "projects create" | "projects update" | "projects delete" | "projects import")
      echo "--help" ;;
    "projects export") echo "--help --output" ;;
    "projects take") echo "--help --slots --inch" ;;
    "projects transfer") echo "--help --insert --check-only" ;;
  esac
}

# True when an option takes a value in the next word.
_rmlcell_takes_value() {
  case $1 in
    --slot | --slots | --main | --executable | --family | --profile | --machine | --origin | --clamps | --inputs | --mode | --override | \
      --simul | --break | --budget | --vars | --svg | --toolpath | --samples | --plot | --stock | --tool | --cell | --material | --stl | --stl-tolerance | --relief | --height-map | --target | --target-slot | --target-tolerance | --target-png | \
      --state-in | --state-out | --server | --etag | --form | \
      --output | -o | --kind | --title | --label | --request-id | --pace | --after | --after-job | --before | --not-before | --priority | --filter | --order | --limit | --move | --turn | --shift | \
      --tolerance | --by | --from | --to | --columns | --rows | --within | --gap | --depth | --step | --passes | --overlap | \
      --dpi | --at | --take-over | --for | --ticket | --job | --reason | --computer | --occurrence | --undo | --seen | --products | --project | --feed | --plunge | --rpm | --clearance) return 0 ;;
  esac
  return 1
}

# Values of an option; false: it has none that can be offered.
_rmlcell_values() {
  case $1 in
    --family) _rmlcell_offer optimo rml1 ;;
    --profile)
      _rmlcell_offer standard mc-1000ipm pw-1993 efa-51 t1 t1a t1n t1s t1f srm-20 mdx-15 mdx-20 mdx-40a \
        mdx-40a-rotary mdx-50 mdx-540 pnc-3200 ;;
    --simul | --break) _rmlcell_offer off ;;
    --mode) _rmlcell_offer cycle remote single repeat ;;
    --kind) _rmlcell_offer simulate check run ;;
    --form) _rmlcell_offer source object executable listing ;;
    --override) _rmlcell_offer 10 25 40 55 70 85 100 115 130 145 ;;
    --pace) _rmlcell_offer 1 10 100 ;;
    --etag) _rmlcell_offer none ;;
    --budget)
      compopt -o nospace 2>/dev/null
      _rmlcell_offer steps= time= ;;
    --filter)
      compopt -o nospace 2>/dev/null
      _rmlcell_offer state= machine= kind= caller= finished= family= verdict= text= since= until= ;;
    --order) _rmlcell_offer newest oldest queue ;;
    --machine) _rmlcell_files .toml ;;
    --svg) _rmlcell_files .svg ;;
    --stl) _rmlcell_files .stl ;;
    --relief | --height-map | --target-png) _rmlcell_files .png ;;
    --target-tolerance) _rmlcell_offer 0.02 0.1 0.5 ;;
    --stl-tolerance) _rmlcell_offer 0.01 0.1 0 ;;
    --stock) _rmlcell_offer 100x80x10 ;;
    --tool) if [[ $verb == simulate || $verb == submit ]]; then _rmlcell_offer flat:3 ball:3 vee:6:60; fi ;;
    --from | --to) _rmlcell_offer 40 100 ;;
    --dpi) _rmlcell_offer 1000 ;;
    --samples) _rmlcell_offer 10 100 1000 10000 ;;
    --plot)
      compopt -o nospace 2>/dev/null
      _rmlcell_offer speed power axes speed,power,axes ;;
    --inputs | --toolpath | --state-in | --state-out | --output | -o) _rmlcell_files ;;
    --products) _rmlcell_offer relief height-map height-grid stl target ;;
    --project) _rmlcell_projects ;;
    --slot | --target-slot) [[ $verb == submit && -n ${given[0]:-} ]] && _rmlcell_slots "${given[0]}" ;;
  esac
}

# What stands where: `given` holds the words that are neither verb nor option.
_rmlcell_positional() {
  local count=${#given[@]}
  case $verb in
    check | simulate | link) _rmlcell_programs_files ;;
    decompile) _rmlcell_files .o ;;
    compile | format | convert | compensate | transform | list) _rmlcell_files .s .si .cmp .o ;;
    diff) _rmlcell_programs_files ;;
    machine)
      [[ $count -eq 0 ]] && _rmlcell_offer status watch enable disable hold stop emergency-stop abort start zero resume mode override \
        factor acknowledge confirm read write start-at key input gates options take taught ;;
    "machine start") if [[ $count -eq 0 ]]; then _rmlcell_machines; else _rmlcell_slots "${given[0]}"; fi ;;
    "machine options") if [[ $count -eq 0 ]]; then _rmlcell_machines; else _rmlcell_offer start=queue start=armed start=person ticket-needed=on ticket-needed=off server-lost=hold server-lost=go-on halt-at-entry=on halt-at-entry=off; fi ;;
    "machine mode") if [[ $count -eq 0 ]]; then _rmlcell_machines; else _rmlcell_offer remote cycle single repeat manual; fi ;;
    "machine key") if [[ $count -eq 0 ]]; then _rmlcell_machines; else _rmlcell_offer X+ X- Y+ Y- Z+ Z- A+ A- PAUSE CONTINUE STOP BUFFER_CLEAR VIEW SPINDLE Z0 ORIGIN HOME COVER POWER EMERGENCY_STOP; fi ;;
    "machine input") if [[ $count -eq 0 ]]; then _rmlcell_machines; else _rmlcell_offer door=open door=closed gate=1 gate=2 power=on power=off emergency-stop=released; fi ;;
    "machine "*) [[ $count -eq 0 ]] && _rmlcell_machines ;;
    rml1) [[ $count -eq 0 ]] && _rmlcell_offer explain to-gcode from-gcode move steps tile from-png ;;
    "rml1 from-gcode") _rmlcell_files .nc .gcode .ngc .tap .cnc ;;
    "rml1 from-png") _rmlcell_files .png ;;
    "rml1 "*) _rmlcell_files .rml .prn ;;
    explain) _rmlcell_codes ;;
    parameters) [[ $count -eq 0 ]] && _rmlcell_offer optimo rml1 ;;
    programs | stale | handbox) [[ $count -eq 0 ]] && _rmlcell_machines ;;
    put)
      case $count in
        0) _rmlcell_machines ;;
        1) [[ -n $cur ]] || _rmlcell_slots "${given[0]}" ;;
        2) _rmlcell_programs_files ;;
      esac ;;
    special) if [[ $count -eq 0 ]]; then _rmlcell_machines; else _rmlcell_offer 1 2 4 90; fi ;;
    get | delete)
      case $count in
        0) _rmlcell_machines ;;
        1) _rmlcell_slots "${given[0]}" ;;
      esac ;;
    submit)
      case $count in
        0) _rmlcell_machines ;;
        1) _rmlcell_programs_files ;;
      esac ;;
    watch | job) [[ $count -eq 0 ]] && _rmlcell_jobs ;;
    cancel | hold | resume | move) [[ $count -eq 0 ]] && _rmlcell_jobs "finished = false" ;;
    report | picture) [[ $count -eq 0 ]] && _rmlcell_jobs "finished = true" ;;
    replay) [[ $count -eq 0 ]] && _rmlcell_files .rmlj && _rmlcell_machines && _rmlcell_jobs "kind = RUN" ;;
    artifact)
      case $count in
        0) _rmlcell_jobs "finished = true" ;;
        1) _rmlcell_artifacts "${given[0]}" ;;
      esac ;;
    projects) [[ $count -eq 0 ]] && _rmlcell_offer list show create update delete transfer take export import ;;
    "projects show" | "projects delete" | "projects export") [[ $count -eq 0 ]] && _rmlcell_projects ;;
    "projects create") [[ $count -eq 1 ]] && _rmlcell_files .json ;;
    "projects update")
      case $count in
        0) _rmlcell_projects ;;
        1) _rmlcell_files .json ;;
      esac ;;
    "projects import") [[ $count -eq 1 ]] && _rmlcell_files .zip ;;
    "projects take") [[ $count -eq 1 ]] && _rmlcell_machines ;;
    "projects transfer")
      case $count in
        0) _rmlcell_projects ;;
        1) _rmlcell_machines ;;
      esac ;;
  esac
}

_rmlcell() {
  local cur=${COMP_WORDS[COMP_CWORD]} verb='' server='' option='' i word
  local -a given=()
  COMPREPLY=()

  # Words up to the present one. readline splits at = and : too: "--kind=run" is three words, and so are
  # "44=FILE" and "host:port".
  for ((i = 1; i < COMP_CWORD; ++i)); do
    word=${COMP_WORDS[i]}
    if [[ $word == [=:]* ]]; then
      [[ $word == : && $option == --server ]] && server+=":${COMP_WORDS[i + 1]}"
      ((i + 1 < COMP_CWORD)) && ((++i))
      continue
    fi
    if [[ $word == -* ]]; then
      option=$word
      if _rmlcell_takes_value "$option"; then
        if [[ ${COMP_WORDS[i + 1]:-} == "=" ]]; then
          ((++i))
        fi
        if ((i + 1 < COMP_CWORD)); then
          ((++i))
          [[ $option == --server ]] && server=${COMP_WORDS[i]}
          [[ $option =~ ^--(plot|samples)$ ]] && ((i + 1 < COMP_CWORD)) && ((++i))  # its file
        fi
      fi
      continue
    fi
    option=''
    if [[ -z $verb ]]; then
      verb=$word
    elif [[ $verb == projects && ${#given[@]} -eq 0 && $word =~ ^(list|show|create|update|delete|transfer|take|export|import)$ ]]; then
      verb="projects $word"
    elif [[ $verb =~ ^(rml1|machine)$ && ${#given[@]} -eq 0 ]]; then
      verb="$verb $word"
    else
      given+=("$word")
    fi
  done

  # A value behind "--option ", "--option=" or "44=".
  local back=1
  [[ $cur == "=" ]] && cur='' && back=0
  local before=${COMP_WORDS[COMP_CWORD - back]}
  if [[ $before == "=" ]]; then
    before=${COMP_WORDS[COMP_CWORD - back - 1]}
    if [[ $before != -* ]]; then  # --slot 44=FILE, --executable 44=FILE, --budget steps=
      [[ ${COMP_WORDS[COMP_CWORD - back - 2]:-} =~ ^--(slot|executable)$ ]] && _rmlcell_programs_files
      return
    fi
  fi
  if [[ $COMP_CWORD -gt 2 && ${COMP_WORDS[COMP_CWORD - 2]} == --samples ]]; then
    _rmlcell_files
    return
  fi
  if [[ ${COMP_WORDS[COMP_CWORD - 2]:-} == --plot && $COMP_CWORD -gt 2 ]]; then
    _rmlcell_files .svg
    return
  fi
  if [[ -n $verb ]] && _rmlcell_takes_value "$before"; then
    _rmlcell_values "$before"
    return
  fi

  if [[ $cur == -* ]]; then
    _rmlcell_offer $(_rmlcell_options "$verb")
  elif [[ -z $verb ]]; then
    _rmlcell_offer check simulate parameters explain compile decompile link format convert compensate transform list \
      diff rml1 lsp machines machine handbox programs put get delete stale special projects submit watch jobs job cancel hold resume move report picture artifact replay
  else
    _rmlcell_positional
  fi
}

complete -F _rmlcell rmlcell
