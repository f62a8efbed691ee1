#!/usr/bin/env bash
# Completions as a shell offers them: completions_test.sh SHARE_FOLDER SHAPELIGHT
set -euo pipefail
share=$1 program=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
touch "$scratch/scan file.ply"

source "$share/bash-completion/completions/shapelight"

# complete_words WORD...: what is offered for the last word, in one line.
complete_words() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1))
  _shapelight
  echo "${COMPREPLY[*]}"
}
expect() {  # expect "OFFERED" WORD...
  local expected=$1 offered
  shift
  offered=$(complete_words "$@")
  [[ $offered == "$expected" ]] || { echo "$*: '$offered' is offered, expected '$expected'" >&2; exit 1; }
}

expect "sample" shapelight sam
expect "--version" shapelight --v
expect "--spacing" shapelight sample --sp
expect "shape stratified" shapelight sample in.ply --method s
expect "shape stratified" shapelight sample in.ply --method = s
expect "auto always" shapelight info --progress a
expect "" shapelight sample --ratio ""
expect "$scratch/scan file.ply" shapelight sample "$scratch/scan"
expect "$scratch/scan file.ply" shapelight register a.ply --init "$scratch/sc"

# Every command and every option that the program knows is offered, by each shell.
for command in $("$program" --help | sed -n '/^Subcommands:/,$ s/^  \([a-z]*\) .*/\1/p'); do
  expect "$command" shapelight "$command"
  for flag in $("$program" "$command" --help | grep -oE '^  -[^ ]*' | grep -oE -- '--[a-z-]+' | sort -u); do
    offered=" $(complete_words shapelight "$command" "$flag") "
    [[ $offered == *" $flag "* ]] || { echo "bash: $command $flag is not offered" >&2; exit 1; }
    grep -q -- "seen_subcommand_from $command' -l ${flag#--} " "$share/fish/vendor_completions.d/shapelight.fish" ||
      { echo "fish: $command $flag is not offered" >&2; exit 1; }
    sed -n "/^    $command) /p" "$share/zsh/vendor-completions/_shapelight" | grep -q -- "$flag\[" ||
      { echo "zsh: $command $flag is not offered" >&2; exit 1; }
  done
done
if command -v zsh >/dev/null; then zsh -n "$share/zsh/vendor-completions/_shapelight"; fi
if command -v fish >/dev/null; then fish -n "$share/fish/vendor_completions.d/shapelight.fish"; fi
