"""Shell completions of the shapelight program, for tools/manual.py."""

NOT_FILES = {"N", "X", "R", "S", "E", "C", "NAME", "FIELD", "FROM", "TEXT", "FLOAT", "INT"}  # values nobody can guess


def is_file(option):
    return bool(option.value) and not option.choices and option.value not in NOT_FILES


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


BASH = """# bash completion of shapelight
_shapelight() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} words=""
  if [[ $word == = ]]; then
    word=""
  elif [[ $previous == = ]]; then
    previous=${{COMP_WORDS[COMP_CWORD-2]}}
  fi
  COMPREPLY=()
  if (( COMP_CWORD == 1 )); then
    COMPREPLY=($(compgen -W "{commands}" -- "$word"))
    return
  fi
  case "${{COMP_WORDS[1]}} $previous" in
{values}
  esac
  if [[ -z $words && $word == -* ]]; then
    case ${{COMP_WORDS[1]}} in
{options}
    esac
  fi
  if [[ -n $words ]]; then
    COMPREPLY=($(compgen -W "$words" -- "$word"))
  else
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
  fi
}}
complete -F _shapelight shapelight
"""


def bash(whole, commands):
    values, options = [], []
    for command in commands:
        names = [name for option in command.options for name in option.names]
        options.append(f'      {command.name}) words="{" ".join(names)}" ;;')
        for option in command.options:
            pattern = "|".join(f'"{command.name} {name}"' for name in option.names)
            if option.choices:
                values.append(f'    {pattern}) words="{" ".join(option.choices)}" ;;')
            elif option.value and not is_file(option):
                values.append(f"    {pattern}) return ;;")
    first = [command.name for command in commands] + [name for option in whole.options for name in option.names]
    return BASH.format(commands=" ".join(first), values="\n".join(values), options="\n".join(options))


ZSH = """#compdef shapelight
_shapelight() {{
  local -a commands=(
{commands}
  )
  if (( CURRENT == 2 )); then
    _describe command commands
    _arguments {options}
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{cases}
  esac
}}
_shapelight "$@"
"""


def zsh_arguments(options):
    specifications = []
    for option in options:
        meaning = option.meaning.translate(str.maketrans("[]:", "()."))
        action = f"({' '.join(option.choices)})" if option.choices else "_files" if is_file(option) else " "
        value = f":{option.value.split('|')[0].lower()}:{action}" if option.value else ""
        others = f"({' '.join(option.names)})" if len(option.names) > 1 else ""
        specifications += [quoted(f"{others}{name}[{meaning}]{value}") for name in option.names]
    return " ".join(specifications)


def zsh(whole, commands):
    described = [f"    {quoted(command.name + ':' + command.meaning)}" for command in commands]
    cases = [f"    {command.name}) _arguments {zsh_arguments(command.options)} '*:file:_files' ;;"
             for command in commands]
    return ZSH.format(commands="\n".join(described), options=zsh_arguments(whole.options), cases="\n".join(cases))


def fish_lines(condition, options):
    for option in options:
        for name in option.names:
            flag = f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}"
            value = ""
            if option.choices:
                value = f" -x -a {quoted(' '.join(option.choices))}"
            elif option.value:
                value = " -r -F" if is_file(option) else " -x"
            yield f"complete -c shapelight -n {quoted(condition)} {flag}{value} -d {quoted(option.meaning)}"


def fish(whole, commands):
    lines = ["# fish completion of shapelight"]
    for command in commands:
        lines.append(f"complete -c shapelight -f -n __fish_use_subcommand -a {command.name} "
                     f"-d {quoted(command.meaning)}")
    lines += fish_lines("__fish_use_subcommand", whole.options)
    for command in commands:
        lines += fish_lines(f"__fish_seen_subcommand_from {command.name}", command.options)
    return "\n".join(lines) + "\n"
